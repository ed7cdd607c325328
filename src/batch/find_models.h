#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "batch/given_options.h"
#include "core/monitor.h"

namespace aerate::batch {

// A model that is to be hollowed, as it was asked for.
struct FoundModel {
  std::filesystem::path model = {};
  std::filesystem::path sub_folder = {};  // below the folder that was searched, in which its result goes
  std::string output = {};                // as a manifest names it
  std::string origin = {};                // "list.csv: line 7"; empty for what the command line names
  std::vector<GivenOption> options = {};  // its own
  std::string fault = {};
};

struct Search {
  std::vector<std::filesystem::path> places;  // models, folders, manifests
  bool is_recursive = false;
  std::filesystem::path results;  // in which none is looked for
};

// In the order of the places, those of a folder by name. Folders are not followed through symbolic links; what is hidden is no model. Folders
// without models are noticed. Throws UsageError if a folder that is searched is that of the results, InputError if there is
// no model at all, and what read_manifest throws.
std::vector<FoundModel> find_models(const Search& search, std::span<const OptionRule> rules,
                                    Monitor& monitor);

}  // namespace aerate::batch
