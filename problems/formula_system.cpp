#include "problems/formula_system.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <deque>
#include <mutex>
#include <numbers>
#include <set>
#include <stdexcept>

#include <muParser.h>

#include "problems/digits.hpp"

namespace hmax {
namespace {

[[noreturn]] void refuse(const std::string& sentence) { throw std::invalid_argument(sentence); }

std::string quoted(std::string_view text) {
  std::string result = "'";
  result += text;
  result += '\'';
  return result;
}

bool starts_identifier(char c) { return std::isalpha(static_cast<unsigned char>(c)) || c == '_'; }
bool continues_identifier(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; }

bool is_identifier(std::string_view name) {
  return !name.empty() && starts_identifier(name[0]) && std::ranges::all_of(name, continues_identifier);
}

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

/// "did you mean 'k1'" when a known name is near, else the list of what is known.
std::string remedy(std::string_view name, const std::vector<std::string>& known) {
  const std::size_t tolerated = name.size() <= 2 ? 1 : 2;
  const std::string* nearest = nullptr;
  std::size_t least = tolerated + 1;
  for (const auto& candidate : known)
    if (const auto distance = edit_distance(name, candidate); distance < least && distance < name.size()) {
      nearest = &candidate;
      least = distance;
    }
  if (nearest) return "did you mean " + quoted(*nearest) + "?";
  std::string list;
  for (const auto& candidate : known) list += (list.empty() ? "" : ", ") + candidate;
  return list.empty() ? "there are none" : "known are " + list;
}

/// A formula as a message shows it: at most 60 characters around a position, control characters as '?'.
std::string shown(const std::string& formula, std::size_t position) {
  const std::size_t first = formula.size() > 60 && position > 30 ? position - 30 : 0;
  std::string text = formula.substr(first, 60);
  std::ranges::replace_if(
      text, [](unsigned char c) { return std::iscntrl(c) != 0; }, '?');
  return (first > 0 ? "\"..." : "\"") + text + (first + 60 < formula.size() ? "...\"" : "\"");
}

/// "equation x' = \"2 * v\", column 3: ", the opening of every complaint about a formula.
std::string where(const std::pair<std::string, std::string>& equation, std::size_t position) {
  position = std::min(position, equation.second.size());
  return "equation " + equation.first + "' = " + shown(equation.second, position) + ", column " +
         std::to_string(position + 1) + ": ";
}

/// Checks what the expression library would accept or explain badly: unknown names, assignments, foreign
/// characters.
void check_tokens(const std::pair<std::string, std::string>& equation,
                  const std::vector<std::string>& known) {
  const std::string& text = equation.second;
  const auto at = [&](std::size_t i) { return i < text.size() ? text[i] : '\0'; };
  if (std::ranges::all_of(text, [](unsigned char c) { return std::isspace(c); }))
    refuse(where(equation, 0) + "the formula is empty; write the derivative, for instance \"0\"");
  std::size_t i = 0;
  while (i < text.size()) {
    const char c = text[i];
    if (std::isdigit(static_cast<unsigned char>(c)) || c == '.') {
      // 1.5e-3: the exponent belongs to the number only when digits follow it.
      while (std::isdigit(static_cast<unsigned char>(at(i))) || at(i) == '.') ++i;
      if (at(i) == 'e' || at(i) == 'E') {
        const std::size_t sign = at(i + 1) == '+' || at(i + 1) == '-' ? 1 : 0;
        if (std::isdigit(static_cast<unsigned char>(at(i + 1 + sign))))
          for (i += 1 + sign; std::isdigit(static_cast<unsigned char>(at(i))); ++i) continue;
      }
      if (starts_identifier(at(i)))
        refuse(where(equation, i) + "a name follows a number directly; write the product with *");
    } else if (starts_identifier(c)) {
      std::size_t end = i;
      while (continues_identifier(at(end))) ++end;
      const auto name = text.substr(i, end - i);
      if (std::ranges::find(known, name) == known.end())
        refuse(where(equation, i) + "the name " + quoted(name) + " is not known; " + remedy(name, known));
      i = end;
    } else if (c == '=' || ((c == '<' || c == '>' || c == '!') && at(i + 1) == '=')) {
      if (c == '=' && at(i + 1) != '=')
        refuse(where(equation, i) +
               "a formula assigns nothing; write only the derivative, and == to compare");
      i += 2;
    } else {
      if (!std::isspace(static_cast<unsigned char>(c)) &&
          std::string_view("+-*/^()<>&|?:,").find(c) == std::string::npos)
        refuse(where(equation, i) + "a formula cannot contain " +
               (std::isprint(static_cast<unsigned char>(c)) ? quoted({&c, 1}) : "this character") +
               "; use names, numbers, + - * / ^ ( ) and functions");
      ++i;
    }
  }
}

std::string explain(const mu::ParserError& error) {
  const auto token = quoted(error.GetToken());
  switch (error.GetCode()) {
    case mu::ecUNEXPECTED_OPERATOR:
      return "the operator " + token + " is out of place; give it a value on both sides";
    case mu::ecUNEXPECTED_EOF:
      return "the formula ends too early; complete it";
    case mu::ecUNEXPECTED_ARG_SEP:
    case mu::ecUNEXPECTED_ARG:
      return "a comma belongs only between the arguments of a function; write decimals with a point";
    case mu::ecUNEXPECTED_PARENS:
      return "the parenthesis " + token + " is out of place; write products with * and close what is open";
    case mu::ecMISSING_PARENS:
      return "a parenthesis is not closed; add ')'";
    case mu::ecUNEXPECTED_VAL:
    case mu::ecUNEXPECTED_VAR:
    case mu::ecUNEXPECTED_FUN:
      return "an operator is missing before " + token + "; write products with *";
    case mu::ecTOO_MANY_PARAMS:
      return "too many arguments for the function " + token + "; remove one";
    case mu::ecTOO_FEW_PARAMS:
      return "too few arguments for the function " + token + "; add one";
    case mu::ecMISPLACED_COLON:
    case mu::ecMISSING_ELSE_CLAUSE:
      return "a condition has the form a ? b : c; write all three parts";
    case mu::ecINTERNAL_ERROR:  // what the library says to a lone sign
      return "a sign without a value; complete the formula";
    default:
      return "the formula cannot be read from here; functions need parentheses, products *, conditions && "
             "and ||";
  }
}

/// The library keeps its number format in one static object, so parsers are built one after another.
std::mutex& parser_construction() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace

struct FormulaSystem::Evaluator {
  std::vector<double> values;  // t, y, parameters: the parsers hold addresses into it, so it never grows
  std::deque<mu::Parser> formulas;

  explicit Evaluator(const FormulaDefinition& definition) {
    const std::scoped_lock lock(parser_construction());
    const auto known = check_names(definition);
    values.assign(1 + definition.equations.size() + definition.parameters.size(), 0.0);
    for (std::size_t i = 0; i < definition.parameters.size(); ++i)
      values[1 + definition.equations.size() + i] = definition.parameters[i].second;
    values[0] = definition.t0;
    std::ranges::copy(definition.y0, values.begin() + 1);
    for (const auto& equation : definition.equations) {
      check_tokens(equation, known);
      parse(definition, equation);
    }
  }

  /// A parser that knows the functions and constants but no variable yet.
  static mu::Parser bare_parser() {
    mu::Parser parser;
    parser.ClearConst();
    parser.DefineConst("pi", std::numbers::pi);
    parser.DefineConst("e", std::numbers::e);
    return parser;
  }

  /// Refuses names that are no identifiers or not free; returns every name that a formula may use.
  static std::vector<std::string> check_names(const FormulaDefinition& definition) {
    std::set<std::string> functions;
    const mu::Parser parser = bare_parser();
    for (const auto& [name, function] : parser.GetFunDef()) functions.insert(name);
    std::set<std::string> taken;
    std::vector<std::string> known;
    const auto add = [&](const std::string& kind, const std::string& name) {
      const std::string what = kind + " " + quoted(name);
      if (!is_identifier(name) || name.size() > 100)
        refuse("the " + what + " is no name; use at most 100 letters, digits and _, a letter first");
      if (name == "t") refuse("the " + what + " has the name of the time; choose another name");
      if (name == "pi" || name == "e")
        refuse("the " + what + " has the name of a constant; choose another name");
      if (functions.contains(name))
        refuse("the " + what + " has the name of a function; choose another name");
      if (!taken.insert(name).second)
        refuse("the " + what + " is defined twice; choose another name for one of them");
      known.push_back(name);
    };
    for (const auto& [name, formula] : definition.equations) add("state", name);
    for (const auto& [name, value] : definition.parameters) add("parameter", name);
    known.insert(known.end(), {"t", "pi", "e"});
    known.insert(known.end(), functions.begin(), functions.end());
    return known;
  }

  void parse(const FormulaDefinition& definition, const std::pair<std::string, std::string>& equation) {
    auto& parser = formulas.emplace_back(bare_parser());
    std::size_t slot = 0;
    parser.DefineVar("t", &values[slot++]);
    for (const auto& [name, formula] : definition.equations) parser.DefineVar(name, &values[slot++]);
    for (const auto& [name, value] : definition.parameters) parser.DefineVar(name, &values[slot++]);
    double start = 0;
    try {
      parser.SetExpr(equation.second);
      start = parser.Eval();
    } catch (const mu::ParserError& error) {
      refuse(where(equation, static_cast<std::size_t>(std::max(error.GetPos(), 0))) + explain(error));
    }
    if (parser.GetNumResults() != 1)
      refuse(where(equation, equation.second.find(',')) +
             "a formula has one value, not several; write decimals with a point, not a comma");
    if (!std::isfinite(start))
      refuse("equation " + equation.first + "' = " + shown(equation.second, 0) +
             ": the derivative is not finite at the start, t0 and y0; change the initial state, a parameter "
             "or the formula");
  }
};

FormulaSystem::FormulaSystem(FormulaDefinition definition) : definition_(std::move(definition)) {
  const auto& d = definition_;
  if (d.equations.empty()) refuse("the system has no equations; give at least one, for instance x = \"-x\"");
  if (d.y0.size() != d.equations.size())
    refuse("the system has " + std::to_string(d.equations.size()) + " equations but " +
           std::to_string(d.y0.size()) + " initial values; give one for each state");
  if (!std::isfinite(d.t0) || !std::isfinite(d.t_end))
    refuse("the time span of the system is not finite; give finite numbers for its start and t_end");
  if (d.t_end < d.t0)
    refuse("t_end is " + shortest_digits(d.t_end) + ", before the start " + shortest_digits(d.t0) +
           "; give a t_end that is later");
  for (std::size_t i = 0; i < d.y0.size(); ++i)
    if (!std::isfinite(d.y0[i]))
      refuse("the initial value of " + quoted(d.equations[i].first) + " is not finite; give a finite number");
  for (const auto& [name, value] : d.parameters)
    if (!std::isfinite(value))
      refuse("the parameter " + quoted(name) + " is not finite; give a finite number");
  evaluator_ = std::make_unique<Evaluator>(d);
}

FormulaSystem::FormulaSystem(const FormulaSystem& other) : FormulaSystem(other.definition_) {}
FormulaSystem::FormulaSystem(FormulaSystem&&) noexcept = default;
FormulaSystem::~FormulaSystem() = default;

FormulaSystem& FormulaSystem::operator=(FormulaSystem other) noexcept {
  std::swap(definition_, other.definition_);
  std::swap(evaluator_, other.evaluator_);
  return *this;
}

void FormulaSystem::rhs(double t, const State& y, State& dydt) const {
  auto& values = evaluator_->values;
  values[0] = t;
  std::copy(y.begin(), y.end(), values.begin() + 1);
  Eigen::Index i = 0;
  for (const auto& formula : evaluator_->formulas) dydt[i++] = formula.Eval();
}

void FormulaSystem::set(std::string_view parameter, double value) {
  if (!std::isfinite(value))
    refuse("the parameter " + quoted(parameter) + " is not finite; give a finite number");
  std::vector<std::string> known;
  for (std::size_t i = 0; i < definition_.parameters.size(); ++i) {
    if (definition_.parameters[i].first == parameter) {
      definition_.parameters[i].second = value;
      evaluator_->values[1 + definition_.equations.size() + i] = value;
      return;
    }
    known.push_back(definition_.parameters[i].first);
  }
  refuse("the system has no parameter " + quoted(parameter) + "; " + remedy(parameter, known));
}

FormulaSystem::State FormulaSystem::y0() const {
  return Eigen::Map<const State>(definition_.y0.data(), static_cast<Eigen::Index>(definition_.y0.size()));
}

}  // namespace hmax
