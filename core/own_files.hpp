/// Which files a program may write over: its own, and no file that it has read.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace hmax {

/// Stands in a comment near the beginning of every file that can have one, so that it is known again.
inline constexpr std::string_view own_mark = "written by hmax";

/// What may be written over.
enum class Replacing {
  any,     ///< every file: a library leaves that to who calls it
  own,     ///< what hmax wrote
  forced,  ///< every file but inputs and stores
};

/// From now on. A program says so once, at its start or by an option.
/// Sets what why_not_replaced() allows. Safe to call from several threads.
void allow_replacing(Replacing which);

/// A file that this process reads, and that no output may replace.
void note_input(const std::filesystem::path& file);

/// True for a file that hmax has written, and for an empty one.
/// @param opening  with which every file of its form begins and no other does; a mark is known without
/// @return  false for a file that cannot be read or does not exist. Only the first 2048 bytes are read.
bool is_own_file(const std::filesystem::path& file, std::string_view opening = {});

/// Why an output may not replace `file`, as one sentence; empty when it may or when there is none.
/// Checked in this order: the rule `any` and files that are not there allow; stores and inputs of this
/// process never are replaced, not even with `forced`; then `own` or `forced` allow.
/// @param own  whether hmax has written it
std::string why_not_replaced(const std::filesystem::path& file, bool own);

}  // namespace hmax
