#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/monitor.h"
#include "studio/lent.h"
#include "studio/names.h"
#include "studio/records.h"

namespace aerate::studio {

// Files of a job in its folder.
inline constexpr const char* kSceneFile = "scene";
inline constexpr const char* kReportFile = "report.json";
inline constexpr const char* kReportTextFile = "report.txt";

// The file of a result in this form.
std::filesystem::path result_in(const std::filesystem::path& folder, const std::string& form);

// Does a job: its results in every form that they have, its reports and its scene are in `folder` then. Throws what hollow() throws.
//   shown: what the user calls the files that texts name
std::vector<ResultFile> run_plan(const Plan& plan, const std::string& model_name,
                                 const std::filesystem::path& folder, const ShownPaths& shown,
                                 const Lent& lent, Monitor& monitor);

}  // namespace aerate::studio
