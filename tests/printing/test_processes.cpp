#include <gtest/gtest.h>
#include <optional>

#include "printing/economics.h"
#include "printing/materials.h"
#include "printing/processes.h"

namespace aerate::test {
namespace {

TEST(Processes, AreTheFourAndFdmIsTheDefault) {
  for (const char* name : {"fdm", "sla", "sls", "metal"}) ASSERT_NE(find_process(name), nullptr) << name;
  EXPECT_EQ(find_process("FDM!"), nullptr);
  const Process& fdm = *find_process("fdm");
  EXPECT_EQ(fdm[Limit::wall]->value, kDefaultLimits.wall);
  EXPECT_EQ(fdm[Limit::gap]->value, kDefaultLimits.gap);
  EXPECT_EQ(fdm[Limit::min_radius]->value, kDefaultLimits.min_radius);
  EXPECT_EQ(fdm[Limit::max_radius]->value, kDefaultLimits.max_radius);
}

TEST(Processes, EveryFigureHasASourceAndCanBePrinted) {
  for (const Process& process : processes()) {
    SCOPED_TRACE(process.name);
    for (const auto& figure : process.limits) {
      if (figure) {
        EXPECT_GT(figure->source.size(), 3U);
      }
    }
    EXPECT_GE(process[Limit::wall]->value, process[Limit::least_wall]->value);
    EXPECT_GE(process[Limit::gap]->value, process[Limit::least_gap]->value);
    EXPECT_LT(process[Limit::min_radius]->value, process[Limit::max_radius]->value);
    EXPECT_NO_THROW(find_material(process.material));
  }
}

TEST(Processes, WhatLeavesMaterialInVoidsHasChannelsThatFitIntoThem) {
  for (const Process& process : processes()) {
    SCOPED_TRACE(process.name);
    const bool needed = process.drainage == Drainage::needed;
    EXPECT_EQ(needed, process.name != "fdm");
    EXPECT_EQ(process[Limit::channel].has_value(), needed);
    EXPECT_EQ(process[Limit::escape_hole].has_value(), needed);
    if (needed) {
      EXPECT_LT(process[Limit::channel]->value, 2 * process[Limit::min_radius]->value);
    }
  }
}

TEST(Processes, TheLargestVoidOfFdmPaysAtAnInfillOf15Percent) {
  const Process& fdm = *find_process("fdm");
  PrintSettings settings;
  settings.infill = 0.15;
  const std::optional<double> least = break_even_radius(settings);
  ASSERT_TRUE(least.has_value());
  EXPECT_GT(fdm[Limit::max_radius]->value, *least);
  // And its ceilings are limited.
  EXPECT_TRUE(fdm[Limit::overhang].has_value());
  EXPECT_TRUE(fdm[Limit::bridge].has_value());
}

TEST(Processes, LimitsAreFoundByTheirNames) {
  for (std::size_t i = 0; i < kLimitCount; ++i) {
    const auto limit = static_cast<Limit>(i);
    EXPECT_EQ(limit_named(name_of(limit)), limit);
  }
  EXPECT_FALSE(limit_named("walls"));
}

}  // namespace
}  // namespace aerate::test
