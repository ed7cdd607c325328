#include <gtest/gtest.h>
#include <optional>
#include <set>
#include <string_view>

#include "printing/economics.h"
#include "printing/materials.h"
#include "printing/processes.h"

namespace aerate::test {
namespace {

TEST(Processes, AreTheFourAndFdmIsTheDefault) {
  for (const char* name : {"fdm", "sla", "sls", "metal"}) ASSERT_NE(find_process(name), nullptr) << name;
  EXPECT_EQ(find_process("FDM!"), nullptr);
  EXPECT_EQ(processes().front().name, "fdm");
}

TEST(Processes, EveryFigureHasASourceAndCanBePrinted) {
  for (const Process& process : processes()) {
    SCOPED_TRACE(process.name);
    for (const auto& [limit, figure] : process.limits)
      EXPECT_GT(figure.source.size(), 3U) << row_of(limit).name;
    for (const LimitRow& row : limit_rows())
      EXPECT_TRUE(process.limits.contains(row.limit) || row.group != LimitGroup::packing) << row.name;
    EXPECT_GE(process.limits.at(Limit::wall).value, process.limits.at(Limit::least_wall).value);
    EXPECT_GE(process.limits.at(Limit::gap).value, process.limits.at(Limit::least_gap).value);
    EXPECT_LT(process.limits.at(Limit::min_radius).value, process.limits.at(Limit::max_radius).value);
    EXPECT_NO_THROW(choose_material(process.material));
  }
}

TEST(Processes, WhatLeavesMaterialInVoidsHasChannelsThatFitIntoThem) {
  for (const Process& process : processes()) {
    SCOPED_TRACE(process.name);
    const bool needed = process.drainage == Drainage::needed;
    EXPECT_EQ(needed, process.name != "fdm");
    EXPECT_EQ(process.limits.contains(Limit::channel), needed);
    EXPECT_EQ(process.limits.contains(Limit::escape_hole), needed);
    if (needed) {
      EXPECT_LT(process.limits.at(Limit::channel).value, 2 * process.limits.at(Limit::min_radius).value);
    }
  }
}

TEST(Processes, TheLargestVoidOfFdmPaysAtAnInfillOf15Percent) {
  const Process& fdm = *find_process("fdm");
  PrintSettings settings;
  settings.infill = 0.15;
  const std::optional<double> least = break_even_radius(settings);
  ASSERT_TRUE(least.has_value());
  EXPECT_GT(fdm.limits.at(Limit::max_radius).value, *least);
  // And its ceilings are limited.
  EXPECT_TRUE(fdm.limits.contains(Limit::overhang));
  EXPECT_TRUE(fdm.limits.contains(Limit::bridge));
}

TEST(Limits, HaveTheirRowsInOrderUnderNamesOfTheirOwn) {
  std::set<std::string_view> names;
  for (std::size_t i = 0; i < kLimitCount; ++i) {
    const auto limit = static_cast<Limit>(i);
    EXPECT_EQ(row_of(limit).limit, limit);
    names.insert(row_of(limit).name);
  }
  EXPECT_EQ(names.size(), kLimitCount);
}

}  // namespace
}  // namespace aerate::test
