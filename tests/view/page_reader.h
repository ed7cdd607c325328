#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>
#include <zlib.h>

#include "core/mesh.h"

namespace aerate::test {

// What a page's data unpacks to: how many bytes there will be is in no place of it.
inline std::string inflated(std::string_view packed) {
  std::string bytes(1 << 16, '\0');
  while (true) {
    uLongf size = bytes.size();
    const int result =
        uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size,
                   reinterpret_cast<const Bytef*>(packed.data()), static_cast<uLong>(packed.size()));
    if (result == Z_OK) {
      bytes.resize(size);
      return bytes;
    }
    if (result != Z_BUF_ERROR) throw std::runtime_error("not deflated");
    bytes.resize(2 * bytes.size());
  }
}

inline std::string from_base64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned held = 0, bits = 0;
  for (const char digit : text.substr(0, text.find('='))) {
    const std::size_t value = kDigits.find(digit);
    if (value == std::string_view::npos) throw std::runtime_error("not base64");
    held = held << 6 | static_cast<unsigned>(value);
    bits += 6;
    if (bits >= 8) bytes.push_back(static_cast<char>(held >> (bits -= 8) & 0xff));
  }
  return bytes;
}

// Numbers of seven bits a byte.
class PageNumbers {
 public:
  explicit PageNumbers(std::string_view bytes) : bytes_(bytes) {}

  std::uint32_t next() {
    std::uint32_t number = 0;
    for (unsigned shift = 0;; shift += 7) {
      const auto byte = static_cast<unsigned char>(bytes_.at(at_++));
      number |= static_cast<std::uint32_t>(byte & 0x7f) << shift;
      if (byte < 0x80) return number;
    }
  }
  std::int64_t next_signed() {
    const std::uint32_t number = next();
    return number & 1 ? -static_cast<std::int64_t>(number >> 1) - 1 : number >> 1;
  }
  bool is_at_end() const { return at_ == bytes_.size(); }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

struct PageTriangles {
  std::vector<std::array<std::int64_t, 3>> places;  // in steps of the grid
  std::vector<Triangle> triangles;
};

// Reads one part after the other. Written apart from the writer, and plainly: the walk is a list whose middle is looked up.
class PageReader {
 public:
  PageReader(std::string_view steps, std::string_view links, std::string_view x, std::string_view y,
             std::string_view z)
      : steps_(steps), links_(links), offsets_{PageNumbers(x), PageNumbers(y), PageNumbers(z)} {}

  void read_part(std::size_t triangle_count) {
    last_ = {0, 0, 0};
    const std::size_t end = read_.triangles.size() + triangle_count;
    walk_.clear();
    while (read_.triangles.size() < end || !walk_.empty()) go_on(steps_.at(at_++));
  }

  bool is_at_end() const {
    return at_ == steps_.size() && links_.is_at_end() && offsets_[0].is_at_end() && offsets_[1].is_at_end() &&
           offsets_[2].is_at_end();
  }
  const PageTriangles& read() const { return read_; }

 private:
  using Place = std::array<std::int64_t, 3>;
  struct Gate {
    std::uint32_t from, to, behind;
  };

  std::uint32_t place(const Place& expected) {
    Place at = expected;
    for (std::size_t k = 0; k < 3; ++k) at[k] += offsets_[k].next_signed();
    read_.places.push_back(at);
    return static_cast<std::uint32_t>(read_.places.size() - 1);
  }
  std::uint32_t link() { return static_cast<std::uint32_t>(read_.places.size()) - 1 - links_.next(); }

  std::size_t wrapped(std::size_t i) const { return i % walk_.size(); }
  Gate& here() { return walk_[here_]; }
  Gate& after() { return walk_[wrapped(here_ + 1)]; }
  Gate& before() { return walk_[wrapped(here_ + walk_.size() - 1)]; }

  void erase(std::size_t i) {
    walk_.erase(walk_.begin() + static_cast<std::ptrdiff_t>(i));
    if (i < here_) --here_;
    if (!walk_.empty()) here_ = wrapped(here_);
  }

  void go_on(char step) {
    if (step >= 8) return start(step);
    if (step == 3) return erase(here_);
    const Gate gate = here();
    std::uint32_t tip = 0;
    if (step == 1) {
      tip = after().to;
      here() = {gate.from, tip, gate.to};
      erase(wrapped(here_ + 1));
    } else if (step == 2) {
      tip = before().from;
      here() = {tip, gate.to, gate.from};
      erase(wrapped(here_ + walk_.size() - 1));
    } else {
      Place expected{};
      for (std::size_t k = 0; k < 3; ++k)
        expected[k] = read_.places[gate.from][k] + read_.places[gate.to][k] - read_.places[gate.behind][k];
      tip = step == 0 ? place(expected) : link();
      here() = {gate.from, tip, gate.to};
      walk_.insert(walk_.begin() + static_cast<std::ptrdiff_t>(here_) + 1, {tip, gate.to, gate.from});
      ++here_;
    }
    read_.triangles.push_back({gate.to, gate.from, tip});
    settle();
  }

  void start(char step) {
    Triangle corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = step & 1 << i ? link() : place(last_);
      last_ = read_.places[corners[i]];
    }
    read_.triangles.push_back(corners);
    for (std::size_t i = 0; i < 3; ++i)
      walk_.push_back({corners[i], corners[(i + 1) % 3], corners[(i + 2) % 3]});
    here_ = 0;
  }

  static bool is_back(const Gate& a, const Gate& b) { return a.from == b.to && a.to == b.from; }

  void settle() {
    while (walk_.size() > 1) {
      if (is_back(here(), after())) {
        const std::size_t size = walk_.size();
        erase(wrapped(here_ + 1));
        erase(here_);
        if (size > 2) here_ = wrapped(here_ + walk_.size() - 1);
      } else if (is_back(here(), before())) {
        const std::size_t size = walk_.size();
        erase(wrapped(here_ + walk_.size() - 1));
        erase(here_);
        if (size > 2) here_ = wrapped(here_ + walk_.size() - 1);
      } else {
        return;
      }
    }
  }

  std::string_view steps_;
  std::size_t at_ = 0;
  PageNumbers links_;
  std::array<PageNumbers, 3> offsets_;
  Place last_{};
  std::vector<Gate> walk_;
  std::size_t here_ = 0;
  PageTriangles read_;
};

}  // namespace aerate::test
