#include "files/weld.h"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace aerate {
namespace {

constexpr std::uint32_t kEmpty = 0xffffffffu;

// The bits of a coordinate with -0 made +0, so that equal coordinates have equal bits.
std::uint32_t canonical_bits(float value) {
  return std::bit_cast<std::uint32_t>(value + 0.0f);
}

std::uint64_t hash_of(Vec3f p) {
  // Multiply and fold; the constants are those of MurmurHash3's 64-bit finaliser.
  std::uint64_t h = (std::uint64_t{canonical_bits(p.x)} << 32) | canonical_bits(p.y);
  h *= 0xff51afd7ed558ccdu;
  h ^= h >> 32;
  h += canonical_bits(p.z);
  h *= 0xc4ceb9fe1a85ec53u;
  return h ^ (h >> 33);
}

}  // namespace

Welder::Welder(std::size_t expected_triangles) {
  // A closed mesh has half as many vertices as triangles.
  const std::size_t expected_vertices = expected_triangles / 2 + kBlock;
  mesh_.triangles.reserve(expected_triangles);
  mesh_.positions.reserve(expected_vertices);
  block_.resize(kBlock);
  slots_.assign(std::bit_ceil(expected_vertices * 2), kEmpty);
}

void Welder::weld_block() {
  // Hashes are computed this many corners ahead, so that their slots are in the cache when they are looked
  // up.
  constexpr std::size_t kAhead = 16;
  make_room();
  std::uint32_t* const slots = slots_.data();
  const std::size_t mask = slots_.size() - 1;
  const std::size_t count = waiting_;
  const std::size_t written = mesh_.triangles.size();
  mesh_.triangles.resize(written + count / 3);

  std::array<std::size_t, kAhead> ahead{};
  for (std::size_t i = 0; i < std::min(kAhead, count); ++i) ahead[i] = hash_of(block_[i]) & mask;
  for (std::size_t i = 0; i < count; ++i) {
    std::size_t slot = ahead[i % kAhead];
    if (i + kAhead < count) {
      const std::size_t upcoming = hash_of(block_[i + kAhead]) & mask;
      __builtin_prefetch(slots + upcoming);
      ahead[i % kAhead] = upcoming;
    }
    const Vec3f corner = block_[i];
    while (slots[slot] != kEmpty && !(mesh_.positions[slots[slot]] == corner)) slot = (slot + 1) & mask;
    if (slots[slot] == kEmpty) {
      slots[slot] = static_cast<std::uint32_t>(mesh_.positions.size());
      mesh_.positions.push_back(corner);
    }
    mesh_.triangles[written + i / 3][i % 3] = slots[slot];
  }
  waiting_ = 0;
}

// Enlarges the table so that it stays at most half full even if every corner of the block is new.
void Welder::make_room() {
  if ((mesh_.positions.size() + waiting_) * 2 <= slots_.size()) return;
  slots_.assign(slots_.size() * 2, kEmpty);
  const std::size_t mask = slots_.size() - 1;
  for (std::size_t vertex = 0; vertex < mesh_.positions.size(); ++vertex) {
    std::size_t slot = hash_of(mesh_.positions[vertex]) & mask;
    while (slots_[slot] != kEmpty) slot = (slot + 1) & mask;
    slots_[slot] = static_cast<std::uint32_t>(vertex);
  }
}

Mesh Welder::finish() && {
  weld_block();
  return std::move(mesh_);
}

Mesh weld(std::span<const Vec3f> corners) {
  Welder welder(corners.size() / 3);
  for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
    welder.add_triangle(corners[i], corners[i + 1], corners[i + 2]);
  }
  return std::move(welder).finish();
}

Mesh as_read_back(const Mesh& mesh) {
  Welder welder(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles)
    welder.add_triangle(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
  return std::move(welder).finish();
}

}  // namespace aerate
