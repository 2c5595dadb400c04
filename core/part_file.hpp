/// A file that is being written beside the one that it will replace.
#pragma once

#include <filesystem>
#include <string_view>

namespace hmax {

/// Where `file` leads through symbolic links, also where nothing is there yet: a file that is renamed onto a
/// link would replace the link. Ends at an open descriptor (/dev/stdout, /proc/PID/fd/N), which links to its
/// file.
std::filesystem::path behind_links(const std::filesystem::path& file);

/// Whether `file` is a pipe, a device or an open descriptor, into which others write as well: it cannot be
/// replaced.
bool is_written_in_place(const std::filesystem::path& file);

/// @throws std::system_error  where such a file is an own descriptor that is not open for writing
void check_in_place(const std::filesystem::path& file);

/// Writes `text` behind what is in such a file. @throws std::system_error
void write_in_place(const std::filesystem::path& file, std::string_view text);

/// Made with a name that nobody can foresee and that nobody else has; removed unless it has replaced its
/// file, by a signal that ends the program too (remove_part_file()). One at a time.
/// Output is written to `file`.RANDOM.part beside its file and renamed when it is complete: whoever reads
/// the file sees the old one or the whole new one, since rename() is atomic within a file system (POSIX). Of
/// a symbolic link the file behind it is replaced.
class PartFile {
 public:
  /// Creates the part with O_EXCL, so that no existing file or link is followed or written over.
  /// @throws std::system_error when it cannot be made
  explicit PartFile(const std::filesystem::path& file);
  /// Closes the part, and removes it unless replace() has moved it.
  ~PartFile();
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;

  /// Appends `text`; continues after short writes and after signals (EINTR).
  /// @throws std::system_error when there is no room
  void write(std::string_view text);
  /// Waits until the part is on the disk (fsync): after replace() a loss of power leaves the old file or the
  /// new one, never an empty one. @throws std::system_error
  void sync();
  /// Moves it to the place of its file. @throws std::system_error
  /// Closes the part first: an error that a file system reports late, on close, leaves the old file in
  /// place.
  void replace();

 private:
  std::filesystem::path file_, part_;  ///< the file to be replaced, and the one being written
  int descriptor_;                     ///< -1 once closed
};

/// Removes the parts of `file` that processes have left which were killed while they wrote it. Nobody else
/// may be writing `file`: the caller sees to that.
void remove_left_parts(const std::filesystem::path& file);

/// For handlers of signals: removes the file that is being written, if there is one.
void remove_part_file() noexcept;

}  // namespace hmax
