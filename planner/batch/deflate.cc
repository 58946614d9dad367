#include "planner/batch/deflate.h"

#include <zlib.h>

#include <new>
#include <stdexcept>

namespace fjr {
namespace {

constexpr std::size_t kMostDeflation = 1032;  // bytes of one packed byte, by zlib's technical notes

const Bytef* zlib_bytes(std::string_view bytes) { return reinterpret_cast<const Bytef*>(bytes.data()); }
Bytef* zlib_bytes(std::string& bytes) { return reinterpret_cast<Bytef*>(bytes.data()); }

}  // namespace

std::string deflated(std::string_view bytes) {
  uLongf size = ::compressBound(bytes.size());
  std::string result(size, '\0');
  const int code = ::compress2(zlib_bytes(result), &size, zlib_bytes(bytes), bytes.size(), Z_DEFAULT_COMPRESSION);
  if (code != Z_OK) throw std::bad_alloc();  // the only thing that can be wrong with room enough
  result.resize(size);
  return result;
}

std::string inflated(std::string_view bytes, std::size_t size) {
  if (size / kMostDeflation > bytes.size()) throw std::runtime_error("packed bytes are damaged");
  uLongf unpacked = size;
  std::string result(size, '\0');
  const int code = ::uncompress(zlib_bytes(result), &unpacked, zlib_bytes(bytes), bytes.size());
  if (code != Z_OK || unpacked != size) throw std::runtime_error("packed bytes are damaged");
  return result;
}

}  // namespace fjr
