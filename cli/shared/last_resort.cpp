#include "cli/shared/last_resort.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <unistd.h>

#include "cli/shared/shown_text.hpp"

namespace hmax {

namespace {

/// Characters on their way to standard error.
class Buffer {
 public:
  void put(char c) noexcept {
    if (used_ == room_.size()) flush();
    room_[used_++] = c;
  }
  /// \x1b for the character that begins control sequences.
  void put_shown(unsigned char c) noexcept {
    constexpr std::string_view digits = "0123456789abcdef";
    for (const char each : {'\\', 'x', digits[c / 16], digits[c % 16]}) put(each);
  }
  void flush() noexcept {
    write_error({room_.data(), used_});
    used_ = 0;
  }

 private:
  std::array<char, 2048> room_;
  std::size_t used_ = 0;
};

}  // namespace

void write_error(std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t written = write(STDERR_FILENO, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

void tell(std::initializer_list<std::string_view> parts) noexcept {
  Buffer line;
  for (const char c : std::string_view("hmax: ")) line.put(c);
  for (const std::string_view part : parts)
    for (std::size_t i = 0; i < part.size();) {
      const char c = part[i];
      const std::size_t control = control_bytes(part, i);
      if (c == '\n' || c == '\r')
        line.put(' ');  // several lines would be several sentences
      else if (control == 0)
        line.put(c);
      else
        for (const char byte : part.substr(i, control)) line.put_shown(static_cast<unsigned char>(byte));
      i += std::max<std::size_t>(control, 1);
    }
  line.put('\n');
  line.flush();
}

void open_closed_streams() noexcept {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    // It gets the lowest number that is free, that of the stream. To standard output nothing can be written
    // then, which is an error as it is without.
    [[maybe_unused]] const int opened = open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
  }
}

}  // namespace hmax
