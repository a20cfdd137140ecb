// Recursive descent parser of the filters of docs/filter.md. Each rule returns the type of the
// parsed term and a formula that evaluates it.

#include "core/debug/filter/filter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include "core/debug/filter/filter_words.hpp"
#include "core/model/text.hpp"

namespace planescope::debug {

/// True is 1, false is 0.
using FilterFormula = std::function<double(const EventView&)>;

struct ParsedFilter {
  FilterFormula formula;
  std::vector<const planes::OptionInfo*> options;  // their values are EventView::options
  std::vector<double> points;                      // their tracks are EventView::points
};

namespace {

/// Deeper than any practical filter, but safe for the stack.
constexpr int kMaxNesting = 64;

struct Operator {
  std::string_view sign;
  double (*apply)(double, double);
  double settled = kAbsent;  // short circuit: a left side with this value is the result
};
using Operators = std::span<const Operator>;

constexpr Operator kOr[] = {{"||", [](double, double b) { return b; }, 1}};
constexpr Operator kAnd[] = {{"&&", [](double, double b) { return b; }, 0}};
constexpr Operator kSums[] = {{"+", [](double a, double b) { return a + b; }},
                              {"-", [](double a, double b) { return a - b; }}};
constexpr Operator kProducts[] = {{"*", [](double a, double b) { return a * b; }},
                                  {"/", [](double a, double b) { return a / b; }}};
/// All comparisons, including !=, are false if the event lacks the value.
constexpr Operator kComparisons[] = {
    {"==", [](double a, double b) -> double { return a == b; }},
    {"!=", [](double a, double b) -> double { return a < b || a > b; }},
    {"<", [](double a, double b) -> double { return a < b; }},
    {"<=", [](double a, double b) -> double { return a <= b; }},
    {">", [](double a, double b) -> double { return a > b; }},
    {">=", [](double a, double b) -> double { return a >= b; }}};

const Operator* find_operator(Operators operators, std::string_view sign) {
  for (const Operator& op : operators)
    if (op.sign == sign) return &op;
  return nullptr;
}

/// A parsed part of the text.
struct Term : FilterPlace {
  FilterType type = FilterType::number;
  FilterFormula formula;
  std::optional<double> constant = {};  // a number or a named value
};

bool is_identity(const Term& term) {
  return term.type == FilterType::plane || term.type == FilterType::point;
}

Term constant(const FilterToken& token, FilterType type, double value) {
  return {token, type, [value](const EventView&) { return value; }, value};
}

std::optional<std::int32_t> number_of_plane_name(std::string_view name) {
  if (name.size() < 2 || (name[0] != 'P' && name[0] != 'p')) return std::nullopt;
  std::int32_t number = 0;
  const char* end = name.data() + name.size();
  const auto [stopped, error] = std::from_chars(name.data() + 1, end, number);
  if (error != std::errc() || stopped != end || number < 1) return std::nullopt;
  return number;
}

std::string meant_by(std::string_view name) {
  if (name == "and") return "&&";
  if (name == "or") return "||";
  if (name == "not") return "!";
  std::vector<std::string> names;
  for (const FilterName& known : filter_names()) names.push_back(known.name);
  return nearest_name(name, names);
}

/// One function per rule of the grammar:
///   any        = all { "||" all }
///   all        = negation { "&&" negation }
///   negation   = "!" negation | comparison
///   comparison = sum [ ( "==" | "!=" | "<" | "<=" | ">" | ">=" ) sum ]
///   sum        = product { ( "+" | "-" ) product }
///   product    = factor { ( "*" | "/" ) factor }
///   factor     = number | name | "-" factor | "(" any ")"
class Parser {
 public:
  Parser(std::string_view text, std::vector<FilterToken> tokens)
      : text_(text), tokens_(std::move(tokens)) {}

  ParsedFilter run() {
    Term whole = any();
    if (at_ < tokens_.size()) fail_behind(whole);
    need(whole, FilterType::boolean);
    filter_.formula = std::move(whole.formula);
    return std::move(filter_);
  }

 private:
  Term any() { return joined(kOr, FilterType::boolean, &Parser::all); }
  Term all() { return joined(kAnd, FilterType::boolean, &Parser::negation); }
  Term sum() { return joined(kSums, FilterType::number, &Parser::product); }
  Term product() { return joined(kProducts, FilterType::number, &Parser::factor); }

  /// Parts of the same type joined by operators, or a single part of any type.
  Term joined(Operators operators, FilterType type, Term (Parser::*part)()) {
    Term first = (this->*part)();
    std::size_t end = first.end;
    std::vector<std::pair<const Operator*, FilterFormula>> rest;
    while (const Operator* op = next_of(operators)) {
      need(first, type);
      ++at_;
      Term right = (this->*part)();
      need(right, type);
      end = right.end;
      rest.emplace_back(op, std::move(right.formula));
    }
    if (rest.empty()) return first;
    return {{first.begin, end},
            type,
            [first = std::move(first.formula), rest = std::move(rest)](const EventView& e) {
              double value = first(e);
              for (const auto& [op, right] : rest)
                if (value != op->settled) value = op->apply(value, right(e));
              return value;
            }};
  }

  /// Parses the part one nesting level deeper.
  Term deeper(Term (Parser::*part)()) {
    if (++depth_ > kMaxNesting) fail_filter(tokens_[at_], "nested too deeply");
    Term inner = (this->*part)();
    --depth_;
    return inner;
  }

  Term negation() { return next_is("!") ? deeper(&Parser::inverted) : comparison(); }
  Term inverted() {
    const std::size_t begin = tokens_[at_++].begin;
    Term inner = negation();
    need(inner, FilterType::boolean);
    inner.begin = begin;
    inner.formula = [of = std::move(inner.formula)](const EventView& e) -> double {
      return !of(e);
    };
    return inner;
  }

  Term comparison() {
    Term left = sum();
    const Operator* op = next_of(kComparisons);
    if (!op) return left;
    const FilterToken sign = tokens_[at_++];
    // `merge` is a stage after `stage==`, and an event type elsewhere.
    const bool is_stage = left.type == FilterType::stage && at_ < tokens_.size() &&
                          tokens_[at_].kind == FilterToken::name;
    Term right = is_stage ? named(tokens_[at_++], FilterType::stage) : sum();
    FilterFormula formula = is_identity(left)    ? identified(left, sign, right)
                            : is_identity(right) ? identified(right, sign, left)
                                                 : compared(left, sign, *op, right);
    if (next_of(kComparisons))
      fail_filter(tokens_[at_], "comparisons cannot be chained; combine them with '&&'");
    return {{left.begin, right.end}, FilterType::boolean, std::move(formula)};
  }

  Term factor() {
    if (at_ == tokens_.size())
      fail_filter(tokens_.back(), fmt::format("expected a value after '{}'", tokens_.back().text));
    return deeper(&Parser::value);
  }
  Term value() {
    const FilterToken token = tokens_[at_++];
    if (token.kind == FilterToken::number) return constant(token, FilterType::number, token.value);
    if (token.kind == FilterToken::name) return named(token);
    if (token.text == "-") {
      Term inner = factor();
      need(inner, FilterType::number);
      return {{token.begin, inner.end},
              FilterType::number,
              [of = std::move(inner.formula)](const EventView& e) { return -of(e); }};
    }
    if (token.text != "(")
      fail_filter(token, fmt::format("expected a value before '{}'", token.text));
    Term inner = any();
    if (at_ == tokens_.size()) fail_filter(token, "missing ')' for this '('");
    if (!next_is(")")) fail_behind(inner);
    inner.begin = token.begin;
    inner.end = tokens_[at_++].end;
    return inner;
  }

  /// If a value and a field share the name, prefers the field unless `wanted` is the value's type.
  Term named(const FilterToken& token, std::optional<FilterType> wanted = {}) {
    if (const FilterSymbol* symbol = find_filter_symbol(token.text, wanted)) {
      if (symbol->value) return constant(token, symbol->type, *symbol->value);
      if (symbol->field) return {token, symbol->type, symbol->field};
      const std::size_t i = filter_.options.size();
      filter_.options.push_back(symbol->option);
      return {token, symbol->type, [i](const EventView& e) { return e.options[i]; }};
    }
    if (const auto plane = number_of_plane_name(token.text))
      return constant(token, FilterType::plane_name, *plane);
    const std::string near = meant_by(token.text);
    fail_filter(token, near.empty()
                           ? fmt::format("'{}' is unknown", token.text)
                           : fmt::format("'{}' is unknown; did you mean '{}'?", token.text, near));
  }

  FilterFormula compared(Term& left, const FilterToken& sign, const Operator& op, Term& right) {
    if (left.type != right.type)
      fail_filter(right, fmt::format("'{}' is {} and cannot be compared with {}", text_of(left),
                                     to_string(left.type), to_string(right.type)));
    if (left.type == FilterType::boolean)
      fail_filter(sign, fmt::format("'{}' is true or false already: remove '{}', or write '!' "
                                    "before it",
                                    text_of(left), sign.text));
    if (left.type != FilterType::number) need_equality(left, sign);
    return [apply = op.apply, left = std::move(left.formula), right = std::move(right.formula)](
               const EventView& e) { return apply(left(e), right(e)); };
  }

  /// plane==7, point!=12: compares with all planes or points of the event.
  FilterFormula identified(Term& field, const FilterToken& sign, const Term& other) {
    need_equality(field, sign);
    const bool is_plane = field.type == FilterType::plane;
    const bool fits =
        other.type == FilterType::number || (is_plane && other.type == FilterType::plane_name);
    if (!fits || !other.constant)
      fail_filter(other, fmt::format("'{}' can only be compared with {}", text_of(field),
                                     is_plane ? "P7 or 7" : "a number"));
    FilterFormula concerned =
        is_plane ? concerns_plane(*other.constant) : concerns_point(*other.constant);
    if (sign.text == "==") return concerned;
    return [any = std::move(field.formula), concerned = std::move(concerned)](
               const EventView& e) -> double { return any(e) && !concerned(e); };
  }

  static FilterFormula concerns_plane(double number) {
    return [number](const EventView& e) -> double {
      const auto is_it = [&](std::int32_t plane) {
        return plane >= 0 && e.run.timeline.number_of_plane(plane) == number;
      };
      return is_it(e.event.plane) || is_it(e.event.other);
    };
  }

  FilterFormula concerns_point(double point) {
    filter_.points.push_back(point);
    return [point, i = filter_.points.size() - 1](const EventView& e) -> double {
      const auto& [nodes, steps] = e.points[i];
      return e.event.point == point ||
             std::binary_search(nodes.begin(), nodes.end(), e.event.node) ||
             std::binary_search(steps.begin(), steps.end(), e.step);
    };
  }

  void need(const Term& term, FilterType type) const {
    if (term.type == type) return;
    fail_filter(term, fmt::format("'{}' is {}{}", text_of(term), to_string(term.type),
                                  type == FilterType::number ? "; expected a number"
                                                             : ": compare it with a value"));
  }
  void need_equality(const Term& term, const FilterToken& sign) const {
    if (sign.text != "==" && sign.text != "!=")
      fail_filter(sign, fmt::format("'{}' is {}: compare it with '==' or '!='", text_of(term),
                                    to_string(term.type)));
  }

  /// Reports unexpected text after a complete term.
  [[noreturn]] void fail_behind(const Term& whole) const {
    const FilterToken& token = tokens_[at_];
    if (token.text == ")") fail_filter(token, "missing '(' for this ')'");
    fail_filter(token,
                fmt::format("expected '&&', '||', or a comparison after '{}'", text_of(whole)));
  }

  std::string_view text_of(const FilterPlace& place) const {
    return text_.substr(place.begin, place.end - place.begin);
  }
  bool next_is(std::string_view sign) const {
    return at_ < tokens_.size() && tokens_[at_].text == sign;
  }
  const Operator* next_of(Operators operators) const {
    return at_ < tokens_.size() ? find_operator(operators, tokens_[at_].text) : nullptr;
  }

  std::string_view text_;
  std::vector<FilterToken> tokens_;
  std::size_t at_ = 0;
  int depth_ = 0;
  ParsedFilter filter_;
};

/// Empty if the run does not contain the point.
PointTrack track_of(double number, const Run& run) {
  PointTrack track;
  const auto count = static_cast<double>(run.segmentation.plane_of.size());
  if (number >= count || number != std::floor(number)) return track;
  const auto point = static_cast<std::int32_t>(number);
  track.nodes = run.timeline.path_of_point(point);
  for (const planes::PointChange& change : run.timeline.changes_of_point(point))
    track.steps.push_back(change.step);
  return track;
}

/// Throws a FilterProblem.
ParsedFilter parse_filter(std::string_view text) {
  std::optional<FilterProblem> problem;
  std::vector<FilterToken> tokens = filter_tokens(text, problem);
  if (problem) throw *problem;
  if (tokens.empty()) return {[](const EventView&) { return 1.0; }, {}, {}};
  return Parser(text, std::move(tokens)).run();
}

std::vector<std::int32_t> matching_of(const ParsedFilter& filter,
                                      const Run& run,
                                      std::int32_t first,
                                      std::int32_t last) {
  std::vector<double> options;
  for (const planes::OptionInfo* option : filter.options)
    options.push_back(planes::number_of(*option, run.options));
  std::vector<PointTrack> points;
  for (const double number : filter.points) points.push_back(track_of(number, run));
  std::vector<std::int32_t> steps;
  for (std::int32_t step = first; step <= last; ++step)
    if (filter.formula({run, step, *run.event_at(step), options, points}) != 0)
      steps.push_back(step);
  return steps;
}

}  // namespace

bool is_comparison(std::string_view sign) { return find_operator(kComparisons, sign) != nullptr; }

std::optional<Filter> Filter::parse(const std::string& text, FilterProblem& problem) {
  try {
    Filter filter;
    filter.text_ = text;
    filter.parsed_ = std::make_shared<const ParsedFilter>(parse_filter(text));
    return filter;
  } catch (FilterProblem& found) {
    problem = std::move(found);
    return std::nullopt;
  }
}

bool Filter::matches(const Run& run, std::int32_t step) const {
  return !parsed_ || !matching_of(*parsed_, run, step, step).empty();
}

std::vector<std::int32_t> Filter::matching(const Run& run) const {
  static const ParsedFilter kAll = parse_filter("");
  return matching_of(parsed_ ? *parsed_ : kAll, run, 1, run.steps());
}

const std::vector<FilterName>& filter_names() {
  static const std::vector<FilterName> names = [] {
    std::vector<FilterName> all;
    for (const FilterSymbol& symbol : filter_symbols())
      all.push_back({symbol.name, symbol.meaning});
    return all;
  }();
  return names;
}

}  // namespace planescope::debug
