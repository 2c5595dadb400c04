/// Figures of measured rows: cost and error against the step, cost of a step, error against cost.
#pragma once

#include <string>
#include <vector>

#include "plots/figure.hpp"
#include "results/row.hpp"

namespace hmax {

/// A method as a figure shows it. Methods of one order share a colour, told apart by dash and marker:
/// parallel lines in the error panel then have one colour.
struct ShownMethod {
  std::string id;          ///< as in RowKey::method
  int order = 0;           ///< of the method; 0 when it has no fixed order
  std::string label = {};  ///< text in the key; the id when empty
  double stable_step = 0;  ///< the largest step at which it is stable on the problem shown [s]; 0: not known
};

/// One style per method, in the order given.
std::vector<Style> method_styles(const std::vector<ShownMethod>& methods);

/// Time of one run (median, bars from quartile to quartile) over global error, against h: one column of
/// panels per mode present among `fixed` and `sampled`. Runs that did not reach the end are marks at the top
/// edge of both panels, with or without numbers of their own. Rows of methods not in `methods` are left out.
/// Times are those of the device of the rows, or CPU times.
/// @throws InputError when the rows belong to several problems, parameters, end times or devices, one was
/// explored, or none is left
Figure step_figure(const std::vector<Row>& rows, const std::vector<ShownMethod>& methods);

/// Time of one step [s] against h, mode `fixed`: what `step_figure` hides in five decades of run length.
Figure step_cost_figure(const std::vector<Row>& rows, const std::vector<ShownMethod>& methods);

/// Time of one run (median, bars from quartile to quartile) and evaluations of f over the global error:
/// fixed steps and adaptive runs together, one curve a method. Runs without an end have no error: notes say
/// which.
/// @param error_words  what the errors are of, on the axis
/// @throws InputError as step_figure
Figure work_precision_figure(const std::vector<Row>& rows, const std::vector<ShownMethod>& methods,
                             const std::string& error_words = "largest error over all outputs");

/// A panel of the time of one run [s] against h for rows of one mode.
Panel run_time_panel(const std::vector<Row>& rows, const std::string& mode,
                     const std::vector<ShownMethod>& methods);

}  // namespace hmax
