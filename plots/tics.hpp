/// Tics and ranges of axes in the words of gnuplot.
#pragma once

#include <string>

#include "plots/figure.hpp"

namespace hmax {

/// `set xtics ...` of an axis of `length` pixels. On a logarithmic one powers of ten, thinned to what has
/// room; a range of less than two decades is also labelled at 2 and 5 times a power, or at 3 times where
/// there is less room. Where fewer than two labels come of that they stand in equal steps, if two have room.
/// An axis of names has bare tics.
std::string tics(char axis_name, const Axis& axis, const Range& range, double length);

/// How far the last label of a linear x-axis reaches beyond the end of the axis [pixels]; 0 of other axes.
double overhang(const Axis& axis, const Range& range, double length);

/// `set xrange ...`, a logarithmic one wider than it is by less than can be seen: gnuplot leaves out tics at
/// its very ends, where the logarithm rounds to beyond them.
std::string drawn_range(char axis_name, const Axis& axis, const Range& range);

}  // namespace hmax
