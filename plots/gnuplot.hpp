/// gnuplot as a program: is it there, quote text for it, run it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hmax {

/// True when a program `gnuplot` can be started and says its version within 10 s.
bool gnuplot_available();

/// Runs `gnuplot script` in `directory`, ignoring the user's own gnuplot settings.
/// @param seconds  after which it is ended, with the processes that it has started; figures of hmax take some
/// seconds
/// @returns empty when it succeeded, otherwise one sentence: not installed (with the remedy), or its first
/// complaint
std::string run_gnuplot(const std::filesystem::path& directory, const std::string& script,
                        double seconds = 60);

/// `text` as a gnuplot string. Single quotes, in which gnuplot substitutes nothing: no backslash, no
/// backtick, no macro. A quote becomes ’ (gnuplot 5.4 misreads a doubled one at the start of a string),
/// control characters become spaces and bytes that are not UTF-8 '?', so that no text, not even a hostile
/// file name, ends the string or the line.
std::string gnuplot_string(std::string_view text);

/// `text` on one line of valid UTF-8: what `gnuplot_string` does without the quotes.
std::string one_line(std::string_view text);

/// Number of characters (code points) of UTF-8 text.
std::size_t length_of(std::string_view text);

/// `text` cut to `most` characters, the last of them an ellipsis.
std::string shortened(std::string_view text, std::size_t most);

/// `text` broken at spaces into lines of at most `most` characters; a longer word has a line of its own.
std::vector<std::string> lines_of(const std::string& text, std::size_t most);

}  // namespace hmax
