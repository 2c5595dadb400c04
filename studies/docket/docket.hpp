/// Public reports of runs that blew up, took too long or showed another material, judged from their numbers
/// alone.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "catalogue/input/toml_file.hpp"
#include "core/embedded_text.hpp"
#include "results/json.hpp"

namespace hmax {

/// studies/docket/*/*.toml, sorted by name; made at configuration by cmake/embed.cmake.
std::span<const EmbeddedText> docket_texts();

/// One run of a report, and what hmax says of it.
///
/// `cause` is what its thread shows, `verdict` what hmax finds:
///   none      ran fine
///   step      its step, or its method at every step, makes it grow
///   model     the model itself grows, whatever steps it
///   work      it needs more steps than it was given
///   accuracy  its end is wrong by more than is allowed
///   material  the stiffness shown is more than 5 % off
///   other     failed for a reason that is none of these; then the verdict is to be none
struct DocketRow {
  std::string name, method;
  std::string asked;  ///< "h 0.01 s", "rtol 1e-06, atol 1e-06", "60 Hz"
  std::string cause, verdict;
  std::string found;   ///< the numbers that the verdict rests on
  std::string remedy;  ///< what helps, in numbers; empty where nothing has to
  bool right = false;  ///< verdict as cause, and what the file takes for a remedy is one
};
HMAX_RECORD(DocketRow, name, method, asked, cause, verdict, found, remedy, right);

struct DocketReport {
  std::string name;  ///< of the file
  std::string title, link, program, version;
  std::string posted, asked, happened;  ///< facts of the thread: its numbers, the question, what came of it
  std::string discussed;              ///< what the verdict rests on, and where it is wrong why; may be empty
  std::vector<std::string> assumed;   ///< numbers that the thread does not have
  bool control = false;               ///< every run was fine, or failed for another reason than its step
  std::vector<std::string> decisive;  ///< assumed numbers whose half or double changes a verdict
  std::vector<DocketRow> rows;        ///< one for each run, at least one
  bool right = false;                 ///< of all rows
};
HMAX_RECORD(DocketReport, name, title, link, program, version, posted, asked, happened, discussed, assumed,
            decisive, control, rows, right);

/// A report as its file has it, judged. Its format is told in docs/reference/commands/reproduce.md:
///
///   - [report] has texts, `control`, the lists `assumed` and `vary`, and the id of a `model` unless
///   - [equations], [parameters], [initial] and [problem] give formulas, as of problem_from();
///   - each [[case]] is a run of a fixed step `h`, which is judged by its stability, of a `rate` of frames,
///     by the stiffness shown, or of `rtol` and `atol`, or of `h` with an allowed `error`, by a run.
///
/// @throws InputError  for what is missing, unknown or no number, with the line
DocketReport docket_report(const TomlDocument& document);

}  // namespace hmax
