/// What the subcommands of `hmax` share: where text goes, how numbers are read, how a run is interrupted.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/numbers.hpp"
#include "results/json.hpp"

namespace hmax {

/// Exit codes of the program; docs/reference/cli.md is the contract.
enum class Exit { done = 0, failed = 1, usage = 2, internal = 3, interrupted = 130 };

/// The terminal or pipe a subcommand talks to. Results go to standard output, everything else to standard
/// error.
class Console {
 public:
  /// Colours and progress only on a terminal; NO_COLOR switches colours off.
  Console();

  bool json = false;            ///< print one JSON document instead of tables
  Exit exit_code = Exit::done;  ///< what the program ends with unless an exception says otherwise

  /// Writes to standard output. Control characters in it, as names in files may have them, are shown and not
  /// sent to the terminal.
  /// @throws InputError when it cannot be written; nothing when the reader went away
  void print(std::string_view text);
  /// Writes one JSON document and a line break; called exactly once by a subcommand when `json` is set.
  void print_json(const Json& document);
  /// One result: the document where `json` is set, else the text.
  void show(const Json& document, std::string_view text) { json ? print_json(document) : print(text); }
  /// Pushes out what is buffered; @throws InputError like print
  void flush();

  /// A warning on standard error, "hmax: warning: text"; the program goes on.
  void remark(std::string_view text);
  /// What happens, on standard error: "hmax: note: text"; nothing is wrong.
  void note(std::string_view text);

  /// True when a line of progress on standard error can be rewritten in place.
  [[nodiscard]] bool shows_progress() const { return progress_; }
  /// Text as standard output shows it: with colour on a terminal, bare elsewhere.
  [[nodiscard]] std::string strong(std::string_view text) const;
  [[nodiscard]] std::string faint(std::string_view text) const;
  [[nodiscard]] std::string alarming(std::string_view text) const;

 private:
  void write(std::string_view text);

  bool colour_, progress_, reader_left_ = false;
};

/// Thrown to leave a long task after Ctrl-C; the program ends with 130 and says what is kept of the work, if
/// anything is.
struct Interrupted {
  std::string kept = {};  ///< a clause such as "the rows so far are printed"; empty where nothing is kept

  /// Of a task whose finished parts are in a file.
  /// @param rows  how many that file has
  static Interrupted with_store(const std::string& file, std::int64_t rows) {
    return {rows > 0 ? "what was finished is kept in " + file : "nothing was finished"};
  }
};

/// From the first call on Ctrl-C sets the flag that is returned, and the task is to end at the next good
/// moment; a second Ctrl-C, more than a second later, ends the program at once. Without a call the first one
/// does.
const std::atomic<bool>& interrupt_flag();

/// One line on standard error that says how far a long task is and how long it will still take. It shows
/// nothing during the first second and on anything but a terminal, and wipes itself out at the end.
class Progress {
 public:
  Progress(const Console& console, std::string task);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Wipes the line, for text to take its place.
  void clear();
  /// @param share   of the work that is done, 0 to 1
  /// @param detail  what is being done now
  void update(double share, std::string_view detail = {});
  /// update() for a task that Ctrl-C ends from now on. The function throws Interrupted then.
  [[nodiscard]] auto watcher() {
    return [this, &interrupted = interrupt_flag()](double share, std::string_view detail = {}) {
      if (interrupted) throw Interrupted{};
      update(share, detail);
    };
  }

 private:
  using Clock = std::chrono::steady_clock;
  std::string task_;
  bool active_;
  bool drawn_ = false;
  Clock::time_point start_, last_;
};

/// While one lives, Ctrl-C, SIGTERM and SIGHUP set a flag in place of ending the program: for a task that
/// saves its state before it ends. A second signal ends the program at once.
class StopFlag {
 public:
  StopFlag();
  ~StopFlag();
  StopFlag(const StopFlag&) = delete;
  StopFlag& operator=(const StopFlag&) = delete;

  [[nodiscard]] bool is_set() const;
};

/// Called once by main.
void install_interrupt_handler();

/// The number that `text` holds. NaN and infinity are numbers here: who uses them says what is wrong.
/// @param what  the option, for the error
/// @throws InputError naming option, text and remedy
double parse_number(std::string_view what, std::string_view text);
/// A whole number of at least `least`; 1e6 is one.
std::int64_t parse_count(std::string_view what, std::string_view text, std::int64_t least);
/// "0.5,1"
std::vector<double> parse_numbers(std::string_view what, std::string_view text);
/// The bounds of a rectangle, "re_from,re_to,im_from,im_to". Beyond 1e150 areas are no numbers any more.
/// @throws InputError naming the option, unless there are four finite numbers, each range from a smaller one
/// to a larger one, within +-1e150
std::array<double, 4> parse_window(std::string_view what, std::string_view text, std::string_view bounds,
                                   std::string_view example);
/// "a,b" without blanks around the parts: the one splitter of lists of names. A setting stays with the name
/// before it, "matrices:stiffness=K.mtx,mass=M.mtx", and "\," is a comma of a name, "a\,b.vtk".
/// @throws InputError when a part is empty
std::vector<std::string> parse_names(std::string_view what, std::string_view text);
/// "m=2" as name and number.
std::pair<std::string, double> parse_assignment(std::string_view what, std::string_view text);
/// Each of them. @throws InputError  where two have one name
std::vector<std::pair<std::string, double>> parse_assignments(std::string_view what,
                                                              const std::vector<std::string>& texts);
/// `word` when it is one of `choices`. @throws InputError with a suggestion
std::string parse_choice(std::string_view what, std::string_view word,
                         std::span<const std::string_view> choices);

/// Columns of text for people: the first is flush left, numbers flush right.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) : rows_{std::move(header)} {}
  /// Line breaks in a cell become blanks, and other control characters are shown.
  void add(std::vector<std::string> row);
  [[nodiscard]] std::string text(const Console& console) const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace hmax
