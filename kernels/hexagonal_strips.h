#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "kernels/constants.h"
#include "kernels/cuda_device.h"
#include "kernels/hexagonal_packing.h"

// The hexagonal packing of models whose index does not fit into the executor's memory: strip by strip along
// y, each with the facets that its places can meet (for distances) or have above them (for winding numbers,
// whose columns run along z). The result is the same to the bit, since no query can see how facets are
// indexed.

namespace aerate::kernels {

struct HexagonalStrip {
  LatticeRows rows;
  Box3d region;  // holds the rows' places and all within reach of them
};

inline HexagonalStrip hexagonal_strip(const HexagonalInput& input, std::uint32_t strip,
                                      std::uint32_t strips) {
  const double radius = input.parameters.lattice_radius;
  const HexagonalLattice lattice = make_hexagonal_lattice(input.box, radius);
  const auto row_of = [&](std::uint64_t k) {
    return static_cast<std::uint32_t>(k * lattice.count_y / strips);
  };
  HexagonalStrip result{{row_of(strip), row_of(std::uint64_t{strip} + 1)}, input.box};
  // Centres lie within -1.16 R and 4.32 R of a row's own y + R, and rows are 2 sqrt(3) R = 3.46 R apart.
  const double margin = 2 * radius + input.parameters.wall;
  const double pitch = 2 * HexagonalLattice::kRow * radius;
  result.region.lower.y = max_of(input.box.lower.y, input.box.lower.y + pitch * result.rows.first - margin);
  result.region.upper.y = min_of(input.box.upper.y, input.box.lower.y + pitch * result.rows.last + margin);
  return result;
}

// Facets that meet the region's range of y.
inline std::vector<Facet> facets_in_strip(const HexagonalInput& input, const Box3d& region) {
  std::vector<Facet> facets;
  for (const std::array<std::uint32_t, 3>& t : input.triangles) {
    const Facet facet{input.positions[t[0]], input.positions[t[1]], input.positions[t[2]]};
    const auto [low, high] = std::minmax({facet.a.y, facet.b.y, facet.c.y});
    if (static_cast<double>(high) >= region.lower.y && static_cast<double>(low) <= region.upper.y) {
      facets.push_back(facet);
    }
  }
  return facets;
}

// Bytes that so many facets and their index need, about.
inline std::size_t hexagonal_index_bytes(std::size_t facets, const CellGrid& cells) {
  constexpr std::size_t kReferences = 6;  // in columns and cells together, for each facet
  constexpr std::size_t kBeside = 1 << 15;
  const auto columns = static_cast<std::size_t>(static_cast<double>(facets) / kFacetsPerColumn);
  return facets * (sizeof(Facet) + kReferences * sizeof(std::uint32_t)) +
         2 * (columns + cells.cell_count()) * sizeof(std::uint32_t) + kBeside;
}

// The same for the largest of so many strips.
inline std::size_t hexagonal_index_bytes(const HexagonalInput& input, std::uint32_t strips) {
  std::vector<Box3d> regions;
  for (std::uint32_t k = 0; k < strips; ++k) regions.push_back(hexagonal_strip(input, k, strips).region);
  // A facet is in consecutive strips: counted where they begin, and off where they end.
  std::vector<std::int64_t> changes(strips + std::size_t{1}, 0);
  for (const std::array<std::uint32_t, 3>& t : input.triangles) {
    const auto [low, high] =
        std::minmax({input.positions[t[0]].y, input.positions[t[1]].y, input.positions[t[2]].y});
    const auto first = std::partition_point(regions.begin(), regions.end(), [low = low](const Box3d& region) {
      return region.upper.y < static_cast<double>(low);
    });
    const auto last = std::partition_point(first, regions.end(), [high = high](const Box3d& region) {
      return region.lower.y <= static_cast<double>(high);
    });
    ++changes[static_cast<std::size_t>(first - regions.begin())];
    --changes[static_cast<std::size_t>(last - regions.begin())];
  }
  std::size_t most = 0;
  std::int64_t facets = 0;
  for (std::uint32_t k = 0; k < strips; ++k) {
    facets += changes[k];
    most = max_of(most, hexagonal_index_bytes(static_cast<std::size_t>(facets),
                                              make_cell_grid(regions[k], input.grid.cell_size)));
  }
  return most;
}

// Packs so many strips one after the other, at most as many as there are rows.
template <typename Executor>
HexagonalResult pack_hexagonal_in_strips(const Executor& executor, const HexagonalInput& input,
                                         std::uint32_t strips) {
  HexagonalPieces pieces;
  for (std::uint32_t k = 0; k < strips; ++k) {
    const HexagonalStrip strip = hexagonal_strip(input, k, strips);
    const auto facets = executor.upload(std::span<const Facet>(facets_in_strip(input, strip.region)));
    hexagonal_detail::pack_rows(
        executor, facets.view(), strip.region, make_cell_grid(strip.region, input.grid.cell_size), strip.rows,
        input, [&](double share) { input.progress((k + share) / strips); }, pieces);
  }
  return pieces.joined();
}

namespace hexagonal_detail {

// As few strips as seem to fit, by powers of two. Throws CudaError (out_of_memory) if even single rows do
// not.
inline std::uint32_t strips_for(const HexagonalInput& input, std::uint32_t rows, std::size_t free_bytes) {
  if (free_bytes == kAsMuchAsIsWanted) return 1;
  const std::size_t usable = free_bytes / 10 * 9;
  for (std::uint64_t strips = 1;; strips *= 2) {
    const auto tried = static_cast<std::uint32_t>(min_of(strips, std::uint64_t{rows}));
    const std::size_t needed = hexagonal_index_bytes(input, tried);
    if (needed <= usable) return tried;
    if (tried < rows) continue;
    throw CudaError(CudaError::Kind::out_of_memory,
                    "packing needs about " + std::to_string((needed >> 10) + 1) +
                        " KiB of device memory even in the thinnest strips of the model, and " +
                        std::to_string(free_bytes >> 10) + " KiB are free",
                    kTooLittleMemoryHint);
  }
}

}  // namespace hexagonal_detail

// The whole job. The triangles go to the executor's memory once, strip by strip where their index does not
// fit into what is free, and each sphere comes back once.
struct HexagonalPacking {
  using Input = HexagonalInput;
  using Result = HexagonalResult;

  template <typename Executor>
  static HexagonalResult pack(const Executor& executor, const HexagonalInput& input) {
    const HexagonalLattice lattice = make_hexagonal_lattice(input.box, input.parameters.lattice_radius);
    const std::uint32_t rows = max_of(lattice.count_y, 1u);
    std::uint32_t strips = hexagonal_detail::strips_for(input, rows, executor.free_bytes());
    while (true) {
      try {
        return strips == 1 ? pack_hexagonal_at_once(executor, input)
                           : pack_hexagonal_in_strips(executor, input, strips);
      } catch (const CudaError& error) {
        // The estimate was too low, or another program was quicker.
        if (error.kind() != CudaError::Kind::out_of_memory || strips >= rows) throw;
        strips = min_of(strips * 2, rows);
      }
    }
  }
};

}  // namespace aerate::kernels
