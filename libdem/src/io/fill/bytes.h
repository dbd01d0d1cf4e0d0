#pragma once
// Vectors of plain values as bytes, in the order of this machine: they do not travel to other
// kinds.

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace dem::io {

template <class T>
void put(std::string& out, const std::vector<T>& values) {
  static_assert(std::is_trivially_copyable_v<T>);
  const std::uint64_t n = values.size();
  out.append(reinterpret_cast<const char*>(&n), sizeof n);
  out.append(reinterpret_cast<const char*>(values.data()), n * sizeof(T));
}

/// Takes them again, in the same order; throws std::runtime_error when bytes are missing.
class Taker {
 public:
  explicit Taker(std::string_view bytes) : bytes_(bytes) {}
  template <class T>
  void take(std::vector<T>& values) {
    std::uint64_t n = 0;
    copy(&n, sizeof n);
    if (n > bytes_.size() / sizeof(T)) throw std::runtime_error("record cut short");
    values.resize(n);
    copy(values.data(), n * sizeof(T));
  }

 private:
  void copy(void* to, std::size_t n) {
    if (n > bytes_.size()) throw std::runtime_error("record cut short");
    if (n > 0) std::memcpy(to, bytes_.data(), n);
    bytes_.remove_prefix(n);
  }
  std::string_view bytes_;
};

}  // namespace dem::io
