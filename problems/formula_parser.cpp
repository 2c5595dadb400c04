#include "problems/formula_parser.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>
#include <ranges>

#include "core/text/sentences.hpp"

namespace hmax {
namespace {

using Id = FormulaNodeId;
using Op = FormulaOp;

struct Function {
  std::string_view name;
  Op op;
  int least, most;  ///< arguments; most 0: any number
};

/// sum, avg, min and max take any number of arguments; `op` joins two of them.
constexpr std::array functions{Function{"abs", Op::abs, 1, 1},     Function{"acos", Op::acos, 1, 1},
                               Function{"acosh", Op::acosh, 1, 1}, Function{"asin", Op::asin, 1, 1},
                               Function{"asinh", Op::asinh, 1, 1}, Function{"atan", Op::atan, 1, 1},
                               Function{"atan2", Op::atan2, 2, 2}, Function{"atanh", Op::atanh, 1, 1},
                               Function{"avg", Op::add, 1, 0},     Function{"cos", Op::cos, 1, 1},
                               Function{"cosh", Op::cosh, 1, 1},   Function{"exp", Op::exp, 1, 1},
                               Function{"ln", Op::log, 1, 1},      Function{"log", Op::log, 1, 1},
                               Function{"log10", Op::log10, 1, 1}, Function{"log2", Op::log2, 1, 1},
                               Function{"max", Op::maximum, 1, 0}, Function{"min", Op::minimum, 1, 0},
                               Function{"pow", Op::power, 2, 2},   Function{"rint", Op::rint, 1, 1},
                               Function{"sign", Op::sign, 1, 1},   Function{"sin", Op::sin, 1, 1},
                               Function{"sinh", Op::sinh, 1, 1},   Function{"sqrt", Op::sqrt, 1, 1},
                               Function{"sum", Op::add, 1, 0},     Function{"tan", Op::tan, 1, 1},
                               Function{"tanh", Op::tanh, 1, 1}};

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool starts_name(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool continues_name(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }
bool is_space(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

/// Levenshtein's distance: the fewest insertions, deletions and substitutions.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i - 1] != b[j - 1]);
      diagonal = row[j];
      row[j] = std::min({substituted, row[j] + 1, row[j - 1] + 1});
    }
  }
  return row[b.size()];
}

struct Token {
  enum class Kind { number, name, symbol, end } kind = Kind::end;
  std::size_t position = 0;
  std::string_view text{};
  double value = 0;
};

/// Cuts the text into tokens and refuses characters that no formula has.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) {
    while (at_ < text_.size()) {
      if (is_space(text_[at_])) {
        ++at_;
        continue;
      }
      if (is_digit(text_[at_]) || text_[at_] == '.')
        read_number();
      else if (starts_name(text_[at_]))
        read_name();
      else
        read_symbol();
    }
    tokens_.push_back({Token::Kind::end, text_.size()});
  }

  [[nodiscard]] const std::vector<Token>& all() const { return tokens_; }

 private:
  [[nodiscard]] char at(std::size_t i) const { return i < text_.size() ? text_[i] : '\0'; }

  void read_number() {
    const std::size_t first = at_;
    while (is_digit(at(at_)) || at(at_) == '.') ++at_;
    const std::string_view mantissa = text_.substr(first, at_ - first);
    if (std::ranges::count(mantissa, '.') > 1 || mantissa == ".")
      throw FormulaError("this is no number; write decimals with one point, such as 1.5", first);
    // 1.5e-3: the exponent belongs to the number only when digits follow it.
    if (at(at_) == 'e' || at(at_) == 'E') {
      const std::size_t sign = at(at_ + 1) == '+' || at(at_ + 1) == '-' ? 1 : 0;
      if (is_digit(at(at_ + 1 + sign)))
        for (at_ += 1 + sign; is_digit(at(at_)); ++at_) continue;
    }
    if (starts_name(at(at_)))
      throw FormulaError("a name follows a number directly; write the product with *", at_);
    Token token{Token::Kind::number, first, text_.substr(first, at_ - first)};
    if (std::from_chars(token.text.data(), token.text.data() + token.text.size(), token.value).ec !=
        std::errc())
      throw FormulaError(
          "the number is outside the range of double; write it with fewer digits or a smaller exponent",
          first);
    tokens_.push_back(token);
  }

  void read_name() {
    const std::size_t first = at_;
    while (continues_name(at(at_))) ++at_;
    tokens_.push_back({Token::Kind::name, first, text_.substr(first, at_ - first)});
  }

  void read_symbol() {
    for (const std::string_view symbol : {"**", "<=", ">=", "==", "!=", "&&", "||"})
      if (text_.substr(at_, 2) == symbol) return keep(2);
    const char c = text_[at_];
    if (c == '=')
      throw FormulaError("a formula assigns nothing; write only the derivative, and == to compare", at_);
    if (c == '&' || c == '|')
      throw FormulaError("conditions are joined by && (and) and || (or); write the sign twice", at_);
    if (std::string_view("+-*/^()<>?:,").find(c) == std::string_view::npos)
      throw FormulaError(
          "a formula cannot contain " +
              (std::isprint(static_cast<unsigned char>(c)) != 0 ? quoted({&c, 1}) : "this character") +
              "; use names, numbers, + - * / ^ ( ) and functions",
          at_);
    keep(1);
  }

  void keep(std::size_t length) {
    tokens_.push_back({Token::Kind::symbol, at_, text_.substr(at_, length)});
    at_ += length;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::vector<Token> tokens_;
};

/// One function for each level of the grammar.
class Parser {
 public:
  Parser(std::string_view text, const FormulaNames& names, FormulaGraph& graph)
      : held_(text), tokens_(held_.all()), names_(names), graph_(graph) {}

  Id formula() {
    const Id value = condition();
    if (next().kind != Token::Kind::end) refuse_next();
    return value;
  }

 private:
  [[nodiscard]] const Token& next() const { return tokens_[at_]; }
  [[nodiscard]] bool sees(std::string_view symbol) const {
    return next().kind == Token::Kind::symbol && next().text == symbol;
  }
  bool takes(std::string_view symbol) {
    if (!sees(symbol)) return false;
    ++at_;
    return true;
  }

  /// a ? b : c, which groups from the right.
  Id condition() {
    const Nesting nesting(*this);
    const Id test = joined();
    if (!takes("?")) return test;
    const Id yes = condition();
    if (!takes(":"))
      throw FormulaError("a condition has the form a ? b : c; write all three parts", next().position);
    return graph_.make(Op::choose, test, yes, condition());
  }

  struct Joint {
    std::string_view symbol;
    Op op;
  };
  template <std::size_t n>
  std::optional<Op> takes_one_of(const std::array<Joint, n>& joints) {
    for (const Joint& joint : joints)
      if (takes(joint.symbol)) return joint.op;
    return std::nullopt;
  }

  Id joined() {
    Id left = both();
    while (takes("||")) left = graph_.make(Op::either, left, both());
    return left;
  }
  Id both() {
    Id left = comparison();
    while (takes("&&")) left = graph_.make(Op::both, left, comparison());
    return left;
  }
  Id comparison() {
    static constexpr std::array joints{Joint{"<", Op::less},    Joint{"<=", Op::less_equal},
                                       Joint{">", Op::greater}, Joint{">=", Op::greater_equal},
                                       Joint{"==", Op::equal},  Joint{"!=", Op::not_equal}};
    const Id left = sum();
    const auto op = takes_one_of(joints);
    if (!op) return left;
    const Id compared = graph_.make(*op, left, sum());
    // 3 > x > 1 would ask whether a truth, 0 or 1, is above 1.
    if (const std::size_t position = next().position; takes_one_of(joints))
      throw FormulaError("comparisons do not chain; write a < b && b < c", position);
    return compared;
  }
  Id sum() {
    static constexpr std::array joints{Joint{"+", Op::add}, Joint{"-", Op::subtract}};
    Id left = product();
    while (const auto op = takes_one_of(joints)) left = graph_.make(*op, left, product());
    return left;
  }
  Id product() {
    static constexpr std::array joints{Joint{"*", Op::multiply}, Joint{"/", Op::divide}};
    Id left = with_sign();
    while (const auto op = takes_one_of(joints)) left = graph_.make(*op, left, with_sign());
    return left;
  }
  Id with_sign() {
    const Nesting nesting(*this);
    if (takes("-")) return graph_.make(Op::negate, with_sign());
    if (takes("+")) return with_sign();
    return power();
  }
  /// The exponent may have a sign and a power of its own.
  Id power() {
    const Id base = value();
    if (!takes("^") && !takes("**")) return base;
    return graph_.make(Op::power, base, with_sign());
  }

  Id value() {
    const Token token = next();
    switch (token.kind) {
      case Token::Kind::end:
        throw FormulaError("the formula ends too early; complete it", token.position);
      case Token::Kind::number:
        ++at_;
        return graph_.constant(token.value);
      case Token::Kind::name:
        ++at_;
        return named(token);
      case Token::Kind::symbol:
        break;
    }
    if (!takes("(")) refuse_operator(token);
    if (sees(")"))
      throw FormulaError("the parentheses are empty; write a value between them", next().position);
    const Id inner = condition();
    close(token);
    return inner;
  }

  Id named(const Token& token) {
    const auto function = std::ranges::find(functions, token.text, &Function::name);
    if (function != functions.end()) return call(*function, token);
    if (const auto found = names_.find(token.text); found != names_.end()) return found->second;
    // As they were given to the graph: states first.
    std::vector<std::pair<Id, std::string>> by_node;
    for (const auto& [name, node] : names_) by_node.emplace_back(node, name);
    std::ranges::stable_sort(by_node, {}, &std::pair<Id, std::string>::first);
    std::vector<std::string> known;
    for (const auto& [node, name] : by_node) known.push_back(name);
    known.insert(known.end(), formula_functions().begin(), formula_functions().end());
    throw FormulaError("the name " + quoted(token.text) + " is not known; " + nearest_name(token.text, known),
                       token.position);
  }

  Id call(const Function& function, const Token& token) {
    const Token open = next();
    if (!takes("("))
      throw FormulaError("the function " + quoted(token.text) +
                             " has no arguments; write them in parentheses, such as " +
                             std::string(token.text) + (function.least == 1 ? "(t)" : "(t, 2)"),
                         token.position);
    std::vector<Id> arguments;
    if (!sees(")")) {
      arguments.push_back(condition());
      while (takes(",")) arguments.push_back(condition());
    }
    close(open);
    const int count = static_cast<int>(arguments.size());
    if (count < function.least)
      throw FormulaError("too few arguments for the function " + quoted(token.text) + "; add one",
                         token.position);
    if (function.most > 0 && count > function.most)
      throw FormulaError("too many arguments for the function " + quoted(token.text) + "; remove one",
                         token.position);
    if (function.most == 1) return graph_.make(function.op, arguments[0]);
    Id joined = arguments[0];
    for (std::size_t i = 1; i < arguments.size(); ++i)
      joined = graph_.make(function.op, joined, arguments[i]);
    return function.name == "avg" ? graph_.make(Op::divide, joined, graph_.constant(count)) : joined;
  }

  void close(const Token& open) {
    if (takes(")")) return;
    if (next().kind == Token::Kind::end)
      throw FormulaError("a parenthesis is not closed; add ')'", open.position);
    refuse_next();
  }

  /// Where a value stands and an operator should follow.
  [[noreturn]] void refuse_next() const {
    const Token& token = next();
    if (token.kind != Token::Kind::symbol)
      throw FormulaError("an operator is missing before " + quoted(token.text) + "; write products with *",
                         token.position);
    if (token.text == ",")
      throw FormulaError(
          "a comma belongs only between the arguments of a function; write decimals with a point",
          token.position);
    if (token.text == ":")
      throw FormulaError("a condition has the form a ? b : c; write all three parts", token.position);
    throw FormulaError("the parenthesis " + quoted(token.text) +
                           " is out of place; write products with * and close what is open",
                       token.position);
  }

  /// Where a value should stand.
  [[noreturn]] static void refuse_operator(const Token& token) {
    if (token.text == ")")
      throw FormulaError("a value is missing before the parenthesis ')'; complete the formula",
                         token.position);
    if (token.text == ",")
      throw FormulaError(
          "a comma belongs only between the arguments of a function; write decimals with a point",
          token.position);
    if (token.text == "?" || token.text == ":")
      throw FormulaError("a condition has the form a ? b : c; write all three parts", token.position);
    throw FormulaError(
        "the operator " + quoted(token.text) + " is out of place; give it a value on both sides",
        token.position);
  }

  /// Each level of parentheses, conditions and signs takes room on the stack.
  class Nesting {
   public:
    explicit Nesting(Parser& parser) : parser_(parser) {
      if (++parser_.depth_ > 1000)
        throw FormulaError(
            "the formula is nested too deeply; give a part of it a state or a parameter of its own",
            parser_.next().position);
    }
    Nesting(const Nesting&) = delete;
    Nesting& operator=(const Nesting&) = delete;
    ~Nesting() { --parser_.depth_; }

   private:
    Parser& parser_;
  };

  Tokens held_;
  const std::vector<Token>& tokens_;
  const FormulaNames& names_;
  FormulaGraph& graph_;
  std::size_t at_ = 0;
  int depth_ = 0;
};

}  // namespace

const std::vector<std::string>& formula_functions() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Function& function : functions) all.emplace_back(function.name);
    return all;
  }();
  return names;
}

std::string formula_language() {
  std::string text = "operators + - * / ^ (or **) < <= > >= == != && || ?:, functions";
  for (const std::string& name : formula_functions()) text += " " + name;
  return text + "; log is the natural logarithm";
}

std::string quoted(std::string_view text) { return "'" + in_one_line(std::string(text)) + "'"; }

std::string nearest_name(std::string_view name, const std::vector<std::string>& known) {
  const std::size_t tolerated = name.size() <= 2 ? 1 : 2;
  const std::string* nearest = nullptr;
  std::size_t least = tolerated + 1;
  for (const auto& candidate : known)
    if (const auto distance = edit_distance(name, candidate); distance < least && distance < name.size()) {
      nearest = &candidate;
      least = distance;
    }
  if (nearest) return "did you mean " + quoted(*nearest) + "?";
  constexpr std::size_t most_listed = 60;
  std::string list;
  for (const auto& candidate : std::views::take(known, most_listed))
    list += (list.empty() ? "" : ", ") + candidate;
  if (known.size() > most_listed) list += " and " + std::to_string(known.size() - most_listed) + " more";
  return list.empty() ? "there are none" : "known are " + list;
}

Id parse_formula(std::string_view text, const FormulaNames& names, FormulaGraph& graph) {
  if (std::ranges::all_of(text, is_space))
    throw FormulaError("the formula is empty; write the derivative, for instance \"0\"", 0);
  return Parser(text, names, graph).formula();
}

}  // namespace hmax
