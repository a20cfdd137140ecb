#include "core/replay/filter_tokens.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace planescope {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Letters, and what UTF-8 writes the paper's symbols with.
bool starts_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' ||
         static_cast<unsigned char>(c) >= 0x80;
}
bool continues_name(char c) { return starts_name(c) || is_digit(c) || c == '.'; }

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

class Lexer {
 public:
  Lexer(std::string_view text, std::optional<FilterProblem>& problem)
      : text_(text), problem_(problem) {}

  std::vector<FilterToken> run() {
    while (at_ < text_.size() && !problem_) {
      const char c = text_[at_];
      if (is_space(c))
        ++at_;
      else if (starts_name(c))
        take(FilterToken::name, length_of_name(at_));
      else if (is_digit(c) || (c == '.' && at_ + 1 < text_.size() && is_digit(text_[at_ + 1])))
        number();
      else
        sign();
    }
    return std::move(tokens_);
  }

 private:
  std::size_t length_of_name(std::size_t from) const {
    std::size_t end = from;
    while (end < text_.size() && continues_name(text_[end])) ++end;
    return end - from;
  }

  void take(FilterToken::Kind kind, std::size_t length, double value = 0) {
    tokens_.push_back({kind, at_, at_ + length, text_.substr(at_, length), value});
    at_ += length;
  }

  void fail(std::size_t length, std::string message) {
    problem_ = FilterProblem{at_, at_ + length, std::move(message)};
  }

  void number() {
    const char* begin = text_.data() + at_;
    double value = 0;
    const auto [stopped, error] = std::from_chars(begin, text_.data() + text_.size(), value);
    const auto length = static_cast<std::size_t>(stopped - begin);
    if (error == std::errc::result_out_of_range) return fail(length, "a number out of range");
    const std::size_t rest = length_of_name(at_ + length);
    if (rest > 0)
      return fail(length + rest,
                  fmt::format("'{}' is no number: write it without a unit, in m or deg",
                              text_.substr(at_, length + rest)));
    take(FilterToken::number, length, value);
  }

  void sign() {
    for (const std::string_view known : {"||", "&&", "==", "!=", "<=", ">="})
      if (text_.substr(at_).starts_with(known)) return take(FilterToken::sign, known.size());
    const char c = text_[at_];
    if (std::string_view("!<>+-*/()").find(c) != std::string_view::npos)
      return take(FilterToken::sign, 1);
    const char* meant = c == '=' ? "==" : c == '&' ? "&&" : c == '|' ? "||" : nullptr;
    if (meant) return fail(1, fmt::format("did you mean '{}'?", meant));
    const bool printable = c > ' ' && c < 0x7f;
    fail(1, printable ? fmt::format("'{}' has no meaning here", c) : "a control character");
  }

  std::string_view text_;
  std::optional<FilterProblem>& problem_;
  std::size_t at_ = 0;
  std::vector<FilterToken> tokens_;
};

}  // namespace

std::vector<FilterToken> filter_tokens(std::string_view text,
                                       std::optional<FilterProblem>& problem) {
  return Lexer(text, problem).run();
}

bool is_comparison(std::string_view sign) {
  constexpr std::string_view kSigns[] = {"==", "!=", "<", "<=", ">", ">="};
  return std::find(std::begin(kSigns), std::end(kSigns), sign) != std::end(kSigns);
}

}  // namespace planescope
