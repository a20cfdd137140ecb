// Recursive descent, one function per line of the grammar in docs/filter.md.

#include "core/replay/filter_parse.hpp"

#include <fmt/format.h>

#include "core/replay/filter_emit.hpp"

namespace planescope {
namespace {

/// Deeper than anyone writes, and not too deep for the stack.
constexpr int kMaxNesting = 64;

class Parser {
 public:
  Parser(std::string_view text, std::vector<FilterToken> tokens)
      : tokens_(std::move(tokens)), emitter_(text) {}

  FilterProgram run() {
    if (tokens_.empty()) return {};
    const FilterTerm all = alternatives();
    if (at_ < tokens_.size()) fail_behind(all);
    emitter_.need_boolean(all);
    return emitter_.take();
  }

 private:
  FilterTerm alternatives() {
    return joined("||", FilterOp::or_else, [this] { return conditions(); });
  }

  FilterTerm conditions() {
    return joined("&&", FilterOp::and_then, [this] { return negation(); });
  }

  template <typename Part>
  FilterTerm joined(std::string_view sign, FilterOp::Code code, Part part) {
    FilterTerm left = part();
    while (next_is(sign)) {
      emitter_.need_boolean(left);
      ++at_;
      const std::size_t jump = emitter_.jump(code);
      const FilterTerm right = part();
      emitter_.need_boolean(right);
      emitter_.land(jump);
      left = {FilterType::boolean, left.begin, right.end};
    }
    return left;
  }

  FilterTerm negation() {
    if (!next_is("!")) return comparison();
    const Nesting nesting(*this);
    const std::size_t begin = tokens_[at_++].begin;
    const FilterTerm inner = negation();
    emitter_.need_boolean(inner);
    emitter_.emit(FilterOp::invert);
    return {FilterType::boolean, begin, inner.end};
  }

  FilterTerm comparison() {
    const FilterTerm left = sum();
    if (!next_is_comparison()) return left;
    const FilterToken sign = tokens_[at_++];
    const bool is_stage = left.type == FilterType::stage && at_ < tokens_.size() &&
                          tokens_[at_].kind == FilterToken::name;
    const FilterTerm right = is_stage ? emitter_.named(tokens_[at_++], left.type) : sum();
    emitter_.compare(left, sign, right);
    if (next_is_comparison())
      fail_filter(tokens_[at_], "comparisons do not chain: join two of them with '&&'");
    return {FilterType::boolean, left.begin, right.end};
  }

  FilterTerm sum() {
    return calculated("+", FilterOp::add, "-", FilterOp::subtract, [this] { return product(); });
  }

  FilterTerm product() {
    return calculated("*", FilterOp::multiply, "/", FilterOp::divide, [this] { return factor(); });
  }

  template <typename Part>
  FilterTerm calculated(std::string_view sign_a,
                        FilterOp::Code code_a,
                        std::string_view sign_b,
                        FilterOp::Code code_b,
                        Part part) {
    FilterTerm left = part();
    while (next_is(sign_a) || next_is(sign_b)) {
      const FilterOp::Code code = next_is(sign_a) ? code_a : code_b;
      ++at_;
      emitter_.need_number(left);
      const FilterTerm right = part();
      emitter_.need_number(right);
      emitter_.emit(code);
      left = {FilterType::number, left.begin, right.end};
    }
    return left;
  }

  FilterTerm factor() {
    if (at_ == tokens_.size())
      fail_filter(tokens_.back(),
                  fmt::format("a value is missing after '{}'", tokens_.back().text));
    const Nesting nesting(*this);
    const FilterToken token = tokens_[at_++];
    if (token.kind == FilterToken::number)
      return emitter_.constant(token, FilterType::number, token.value);
    if (token.kind == FilterToken::name) return emitter_.named(token);
    if (token.text == "-") {
      const FilterTerm inner = factor();
      emitter_.need_number(inner);
      emitter_.emit(FilterOp::negate);
      return {FilterType::number, token.begin, inner.end};
    }
    if (token.text != "(")
      fail_filter(token, fmt::format("a value is expected before '{}'", token.text));
    const FilterTerm inner = alternatives();
    if (at_ == tokens_.size()) fail_filter(token, "this '(' is never closed");
    if (!next_is(")")) fail_behind(inner);
    return {inner.type, token.begin, tokens_[at_++].end, inner.constant};
  }

  bool next_is(std::string_view sign) const {
    return at_ < tokens_.size() && tokens_[at_].kind == FilterToken::sign &&
           tokens_[at_].text == sign;
  }
  bool next_is_comparison() const {
    return at_ < tokens_.size() && tokens_[at_].kind == FilterToken::sign &&
           is_comparison(tokens_[at_].text);
  }

  /// Something stands behind what is whole already.
  [[noreturn]] void fail_behind(const FilterTerm& whole) const {
    const FilterToken& token = tokens_[at_];
    if (token.text == ")") fail_filter(token, "this ')' was never opened");
    fail_filter(token, fmt::format("'&&', '||' or a comparison is missing after '{}'",
                                   emitter_.text_of(whole)));
  }

  /// Counts how deep the recursion is.
  class Nesting {
   public:
    explicit Nesting(Parser& parser) : parser_(parser) {
      if (++parser_.depth_ > kMaxNesting)
        fail_filter(parser_.tokens_[parser_.at_], "nested too deeply");
    }
    ~Nesting() { --parser_.depth_; }
    Nesting(const Nesting&) = delete;
    Nesting& operator=(const Nesting&) = delete;

   private:
    Parser& parser_;
  };

  std::vector<FilterToken> tokens_;
  std::size_t at_ = 0;
  int depth_ = 0;
  FilterEmitter emitter_;
};

}  // namespace

std::optional<FilterProgram> parse_filter(std::string_view text, FilterProblem& problem) {
  std::optional<FilterProblem> no_word;
  std::vector<FilterToken> tokens = filter_tokens(text, no_word);
  if (no_word) {
    problem = std::move(*no_word);
    return std::nullopt;
  }
  try {
    return Parser(text, std::move(tokens)).run();
  } catch (FilterFailed& failed) {
    problem = std::move(failed.problem);
    return std::nullopt;
  }
}

}  // namespace planescope
