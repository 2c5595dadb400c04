#include "plots/pages/encodings/deflate.hpp"

#if HMAX_HAVE_ZLIB
#include <zlib.h>
#endif

namespace hmax {

#if HMAX_HAVE_ZLIB
std::string deflated(std::string_view text) {
  uLongf size = compressBound(text.size());
  std::string small(size, '\0');
  const int code = compress2(reinterpret_cast<Bytef*>(small.data()), &size,
                             reinterpret_cast<const Bytef*>(text.data()), text.size(), Z_BEST_COMPRESSION);
  small.resize(code == Z_OK ? size : 0);
  return small;
}
#else
std::string deflated(std::string_view) { return {}; }
#endif

}  // namespace hmax
