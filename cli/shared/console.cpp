#include "cli/shared/console.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <limits>
#include <unistd.h>

#include <fmt/format.h>

#include "catalogue/input/suggest.hpp"
#include "cli/shared/last_resort.hpp"
#include "cli/shared/shown_text.hpp"
#include "core/errors.hpp"
#include "core/numbers.hpp"
#include "core/part_file.hpp"
#include "core/text/split.hpp"

namespace hmax {

namespace {

std::atomic<bool> interrupted{false}, waits_for_task{false}, saves_first{false};
std::atomic<std::time_t> asked_to_end{0};  // the first time

/// Whether a signal only tells a task to end. Who signals a process and its group, as timeout(1), asks once:
/// a second wish comes more than a second later.
bool is_first_wish() {
  const std::time_t now = std::time(nullptr);
  if (interrupted.exchange(true)) return now - asked_to_end <= 1;
  asked_to_end = now;
  return true;
}

extern "C" void on_interrupt(int) {
  if (waits_for_task.load() && is_first_wish()) return;
  remove_part_file();
  write_error("hmax: interrupted\n");
  _exit(static_cast<int>(Exit::interrupted));
}

/// Ends the program as the signal does by itself, which is told to who waits for it; a task that saves its
/// state is asked to do that first.
extern "C" void on_termination(int signal) {
  if (saves_first.load() && is_first_wish()) return;
  remove_part_file();
  std::signal(signal, SIG_DFL);
  raise(signal);
}

bool is_set(const char* variable) {
  const char* value = std::getenv(variable);
  return value && *value;
}

bool is_terminal(int descriptor) {
  const char* kind = std::getenv("TERM");
  return isatty(descriptor) && !(kind && std::strcmp(kind, "dumb") == 0);
}

std::string painted(bool colour, const char* code, std::string_view text) {
  return colour ? painted_text(code, text) : std::string(text);
}

/// The number of characters on the screen: control sequences take no room, UTF-8 one place a code point.
std::size_t width_of(std::string_view text) {
  std::size_t width = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\x1b') {
      while (i < text.size() && text[i] != 'm') ++i;
    } else if ((static_cast<unsigned char>(text[i]) & 0xC0U) != 0x80U) {
      ++width;
    }
  }
  return width;
}

bool is_number_in_words(std::string_view cell) {
  return cell.empty() || cell == "-" || cell == no_number || cell == too_large || cell == too_low ||
         to_number(cell).has_value();
}

/// Whether a value is, or a list of any depth holds, a number that JSON has no digits for.
bool lacks_digits(const Json& value) {
  if (value.is_number_float()) return !std::isfinite(value.get<double>());
  return value.is_array() && std::ranges::any_of(value, lacks_digits);
}

/// Gives every object in which numbers become null a `status` that names them, after what it says already.
void explain_nulls(Json& value) {
  if (value.is_structured())
    for (Json& part : value) explain_nulls(part);
  if (!value.is_object()) return;
  std::string names;
  for (const auto& [name, part] : value.items())
    if (lacks_digits(part)) names += (names.empty() ? "" : ", ") + name;
  if (names.empty()) return;
  Json& status = value["status"];
  const std::string before = status.is_string() ? status.get<std::string>() : "";
  status = fmt::format("{}{}beyond the range of numbers: {}", before, before.empty() ? "" : "; ", names);
}

std::string remaining_time(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", std::ceil(seconds));
  if (seconds < 5400) return fmt::format("{:.0f} min", std::ceil(seconds / 60));
  return fmt::format("{:.1f} h", seconds / 3600);
}

}  // namespace

Console::Console()
    : colour_(is_terminal(STDOUT_FILENO) && !is_set("NO_COLOR")), progress_(is_terminal(STDERR_FILENO)) {}

void Console::print(std::string_view text) { write(shown_text(text, {.colours = colour_})); }

void Console::write(std::string_view text) {
  if (reader_left_) return;
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size()) return;
  // A reader that has seen enough (`hmax ... | head`) is no error.
  if (errno == EPIPE) {
    reader_left_ = true;
    return;
  }
  throw InputError(fmt::format("cannot write to standard output ({}); make room or redirect it elsewhere",
                               std::strerror(errno)));
}

void Console::print_json(const Json& document) {
  Json explained = document;
  explain_nulls(explained);
  // A name that is not UTF-8 has a substitute for each byte that is none.
  write(explained.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

void Console::flush() {
  if (reader_left_) return;
  errno = 0;
  if (std::fflush(stdout) == 0 || errno == EPIPE) return;
  throw InputError(fmt::format("cannot write to standard output ({}); make room or redirect it elsewhere",
                               std::strerror(errno)));
}

void Console::remark(std::string_view text) { tell({"warning: ", text}); }
void Console::note(std::string_view text) { tell({"note: ", text}); }

std::string Console::strong(std::string_view text) const { return painted(colour_, "1", text); }
std::string Console::faint(std::string_view text) const { return painted(colour_, "2", text); }
std::string Console::alarming(std::string_view text) const { return painted(colour_, "1;31", text); }

Progress::Progress(const Console& console, std::string task)
    : task_(std::move(task)), active_(console.shows_progress()), start_(Clock::now()), last_(start_) {}

Progress::~Progress() { clear(); }

void Progress::clear() {
  if (drawn_) write_error("\r\x1b[K");
  drawn_ = false;
}

void Progress::update(double share, std::string_view detail) {
  if (!active_) return;
  const auto now = Clock::now();
  using Seconds = std::chrono::duration<double>;
  const double elapsed = Seconds(now - start_).count();
  if (elapsed < 1 || (drawn_ && Seconds(now - last_).count() < 0.2)) return;
  last_ = now;
  drawn_ = true;
  const std::string rest =
      share > 0 ? ", " + remaining_time(elapsed * (1 - share) / share) + " to go" : std::string();
  write_error(fmt::format("\r\x1b[K{}: {:.0f} %{}{}{}", shown_text(task_, {.line_breaks = false}),
                          std::floor(100 * share), rest, detail.empty() ? "" : "  ",
                          shown_text(detail, {.line_breaks = false})));
}

const std::atomic<bool>& interrupt_flag() {
  // Written once: others wait for the line of what is written in every step.
  if (!waits_for_task.load(std::memory_order_relaxed)) waits_for_task = true;
  return interrupted;
}

StopFlag::StopFlag() { saves_first = waits_for_task = true; }
StopFlag::~StopFlag() { saves_first = waits_for_task = false; }
bool StopFlag::is_set() const { return interrupted.load(std::memory_order_relaxed); }

void install_interrupt_handler() {
  std::signal(SIGINT, on_interrupt);
  for (const int signal : {SIGTERM, SIGHUP})
    if (std::signal(signal, on_termination) == SIG_IGN) std::signal(signal, SIG_IGN);  // nohup
  std::signal(SIGPIPE, SIG_IGN);
  // A limit on the size of files is then an error of write(), told like a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
}

double parse_number(std::string_view what, std::string_view text) {
  if (const auto value = to_number(text)) return *value;
  const bool comma = text.find(',') != std::string_view::npos;
  throw InputError(fmt::format(
      "{} is '{}', which is not a number within the range of double; {}", what, text,
      comma ? "write the decimal point as '.', 1.5 and not 1,5" : "write it like 0.01, 1e-2 or 1.0D-2"));
}

std::int64_t parse_count(std::string_view what, std::string_view text, std::int64_t least) {
  const double value = to_number(text).value_or(std::numeric_limits<double>::quiet_NaN());
  if (!(value >= static_cast<double>(least)) || value > 9e15 || value != std::floor(value))
    throw InputError(fmt::format("{} is '{}' but must be a whole number of at least {}", what, text, least));
  return static_cast<std::int64_t>(value);
}

namespace {

/// The parts between commas, also empty ones: "\," is a comma of a part.
std::vector<std::string> parts_between_commas(std::string_view text) {
  std::vector<std::string> parts;
  bool goes_on = false;
  for (std::string_view part : split(text, ",")) {
    const bool escapes = part.ends_with('\\') && part.data() + part.size() != text.data() + text.size();
    if (escapes) part.remove_suffix(1);
    if (goes_on)
      parts.back().append(",").append(part);
    else
      parts.emplace_back(part);
    goes_on = escapes;
  }
  return parts;
}

/// Whether a part is a setting of the name before it, as substeps=10 of vbd:iterations=1,substeps=10.
bool is_setting_of(std::string_view name, std::string_view part) {
  const auto first = [](std::string_view of) { return of.substr(0, of.find_first_of(":=")).size(); };
  const bool sets = first(part) < part.size() && part[first(part)] == '=';
  return sets && name.find(':') < name.find('=') && name.find('=') != name.npos;
}

}  // namespace

std::vector<std::string> parse_names(std::string_view what, std::string_view text) {
  std::vector<std::string> names;
  for (const std::string& each : parts_between_commas(text)) {
    const std::string_view part = trimmed(each);
    if (part.empty())
      throw InputError(
          fmt::format("{} is '{}', where a part is empty; write the parts with commas between "
                      "them and none at the ends",
                      what, text));
    if (!names.empty() && is_setting_of(names.back(), part))
      names.back().append(",").append(part);
    else
      names.emplace_back(part);
  }
  return names;
}

std::vector<double> parse_numbers(std::string_view what, std::string_view text) {
  std::vector<double> numbers;
  for (const std::string& part : parse_names(what, text)) numbers.push_back(parse_number(what, part));
  return numbers;
}

std::array<double, 4> parse_window(std::string_view what, std::string_view text, std::string_view bounds,
                                   std::string_view example) {
  constexpr double most = 1e150;
  const std::vector<double> numbers = parse_numbers(what, text);
  if (numbers.size() != 4)
    throw InputError(
        fmt::format("{} has {} numbers but needs four: {}, like {}", what, numbers.size(), bounds, example));
  for (const double value : numbers)
    if (!(std::abs(value) <= most))
      throw InputError(std::isfinite(value)
                           ? fmt::format("{} holds {}; give numbers within +-{}, like {}", what,
                                         to_text(value), to_text(most), example)
                           : fmt::format("{} holds {}, which is not a finite number", what, to_text(value)));
  for (const std::size_t i : {0U, 2U})
    if (!(numbers[i] < numbers[i + 1]))
      throw InputError(
          fmt::format("{} goes from {} to {}, which is no rectangle; write the smaller number first, like {}",
                      what, to_text(numbers[i]), to_text(numbers[i + 1]), example));
  return {numbers[0], numbers[1], numbers[2], numbers[3]};
}

std::pair<std::string, double> parse_assignment(std::string_view what, std::string_view text) {
  // The last: names of sets and regions may have one, as in support:z<=0.01=1.
  const std::size_t equals = text.rfind('=');
  if (equals == std::string_view::npos || equals == 0)
    throw InputError(fmt::format("{} is '{}' but must name a parameter and its value, like c=6", what, text));
  return {std::string(text.substr(0, equals)),
          parse_number(fmt::format("{} {}", what, text.substr(0, equals)), text.substr(equals + 1))};
}

std::vector<std::pair<std::string, double>> parse_assignments(std::string_view what,
                                                              const std::vector<std::string>& texts) {
  std::vector<std::pair<std::string, double>> all;
  for (const std::string& text : texts) {
    auto one = parse_assignment(what, text);
    if (std::ranges::find(all, one.first, &std::pair<std::string, double>::first) != all.end())
      throw InputError(fmt::format("{} {} is given twice; leave one of them out", what, one.first));
    all.push_back(std::move(one));
  }
  return all;
}

std::string parse_choice(std::string_view what, std::string_view word,
                         std::span<const std::string_view> choices) {
  if (std::ranges::find(choices, word) != choices.end()) return std::string(word);
  throw InputError(fmt::format("{} is '{}'; {}", what, word, suggestion(word, choices)));
}

void TextTable::add(std::vector<std::string> row) {
  for (std::string& cell : row) cell = shown_text(cell, {.line_breaks = false, .colours = true});
  rows_.push_back(std::move(row));
}

std::string TextTable::text(const Console& console) const {
  std::vector<std::size_t> widths(rows_[0].size(), 0);
  for (const auto& row : rows_)
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], width_of(row[c]));
  // A column of numbers, blanks and dashes is flush right.
  std::vector<bool> right(widths.size(), true);
  right[0] = false;
  for (std::size_t r = 1; r < rows_.size(); ++r)
    for (std::size_t c = 0; c < rows_[r].size(); ++c) right[c] = right[c] && is_number_in_words(rows_[r][c]);
  std::string text;
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    std::string line;
    for (std::size_t c = 0; c < rows_[r].size(); ++c) {
      const std::string pad(widths[c] - width_of(rows_[r][c]), ' ');
      line += (c ? "  " : "") + (right[c] ? pad + rows_[r][c] : rows_[r][c] + pad);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += (r == 0 ? console.strong(line) : line) + "\n";
  }
  return text;
}

}  // namespace hmax
