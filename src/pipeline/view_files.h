#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "core/monitor.h"
#include "pipeline/announced_file.h"
#include "pipeline/view_outputs.h"
#include "view/scene.h"

namespace aerate {

// The files of what is to be shown, made before the long stages, so that a place that cannot be written to is found at once. They appear
// together with the result.
class ViewFiles {
 public:
  // Throws UsageError for a name that does not end in what is written and for a page that the program was built without,
  // FailureError for a place that cannot be written to.
  ViewFiles(const ViewOutputs& outputs, Monitor& monitor);

  // Writes all of them beside their targets, as a stage each. `make_scene` is called if there are any. Throws FailureError.
  void write(const std::function<Scene()>& make_scene, Monitor& monitor);

  // Commits what was written, and the result with it, which comes last; see commit_all.
  void commit_with(std::vector<PendingFile*> results);

 private:
  const ViewOutputs& outputs_;
  std::unique_ptr<AnnouncedFile> picture_, page_;
};

}  // namespace aerate
