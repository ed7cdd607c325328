// aerate._core: the commands of the program as functions over NumPy arrays. What is Python about the module is in aerate/.

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <memory>
#include <mutex>
#include <new>
#include <optional>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <span>
#include <string>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include "cli/called_commands.h"
#include "core/error.h"
#include "core/mesh.h"
#include "core/monitor.h"

namespace py = pybind11;

namespace aerate {
namespace {

// Rows of a mesh, contiguous.
using Vertices = py::array_t<double, py::array::c_style>;
using Triangles = py::array_t<std::int64_t, py::array::c_style>;

// The jobs of this process, which the interpreter's end has to wait for: a thread that asks for its lock afterwards is ended by it wherever it is.
class Jobs {
 public:
  // Throws where the interpreter is at its end.
  void begin() {
    const std::scoped_lock lock(mutex_);
    if (is_ending_) throw Ending();
    ++count_;
  }
  void end() {
    const std::scoped_lock lock(mutex_);
    --count_;
    ended_.notify_all();
  }
  // Stops them, and waits for their ends.
  void end_all() {
    std::unique_lock lock(mutex_);
    is_ending_ = true;
    ended_.wait(lock, [&] { return count_ == 0; });
  }
  bool is_ending() const { return is_ending_; }

  struct Ending {};

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  std::size_t count_ = 0;
  std::atomic<bool> is_ending_ = false;
};

// A process that is forked has none: it gets others, and nobody waits for those of its parent.
std::unique_ptr<Jobs>& jobs() {
  static auto* const jobs =
      new std::unique_ptr<Jobs>(std::make_unique<Jobs>());  // never gone: threads may outlive all else
  return *jobs;
}
// Nor has it the threads that libraries began when they were loaded, and for which they would wait at its end for ever: it ends before they do.
void forget_jobs() {
  static_cast<void>(jobs().release());
  jobs() = std::make_unique<Jobs>();
  static_cast<void>(::on_exit(
      [](int status, void*) {
        std::fflush(nullptr);
        ::_exit(status);
      },
      nullptr));
}

class JobGuard {
 public:
  JobGuard() { jobs_.begin(); }
  ~JobGuard() { jobs_.end(); }
  JobGuard(const JobGuard&) = delete;
  JobGuard& operator=(const JobGuard&) = delete;

 private:
  Jobs& jobs_ = *jobs();
};

// Tells a Python function what is done, and stops where that or a signal's handler raises. For the thread that runs the job
// without the interpreter's lock; stages may ask from others whether to stop.
class CallingMonitor final : public Monitor {
 public:
  explicit CallingMonitor(py::object progress) : progress_(std::move(progress)) {}

  void stage(std::string_view name) override {
    stage_ = name;
    percent_ = 0;
    tell(0);
  }

  void progress(double fraction) override {
    const int percent = static_cast<int>(100 * fraction);
    if (percent == std::exchange(percent_, percent)) return;
    tell(fraction);
  }

  // Handlers run in Python's main thread alone. The lock is asked for rarely: other threads of Python may be busy with it.
  void check_interrupted() override {
    constexpr std::chrono::milliseconds kBetween{50};
    if (jobs()->is_ending()) throw Jobs::Ending();
    const Clock::time_point now = Clock::now();
    if (now - asked_.load() < kBetween) return;
    asked_ = now;
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
  }

 private:
  using Clock = std::chrono::steady_clock;

  void tell(double fraction) {
    if (progress_.is_none()) return;
    const py::gil_scoped_acquire lock;
    progress_(stage_, fraction);
  }

  py::object progress_;
  std::string stage_;
  int percent_ = -1;
  std::atomic<Clock::time_point> asked_{Clock::time_point{}};
};

const cli::CalledCommand& command_of(const std::string& name) {
  for (const cli::CalledCommand& command : cli::called_commands())
    if (name == command.name) return command;
  throw py::key_error(name);
}

py::array_t<double> rows_of(const std::vector<Vec3f>& positions) {
  py::array_t<double> rows({static_cast<py::ssize_t>(positions.size()), py::ssize_t{3}});
  double* to = rows.mutable_data();
  for (const Vec3f& position : positions) {
    const Vec3d p = to_double(position);
    for (const double coordinate : {p.x, p.y, p.z}) *to++ = coordinate;
  }
  return rows;
}

py::array_t<std::int32_t> rows_of(const std::vector<Triangle>& triangles) {
  py::array_t<std::int32_t> rows({static_cast<py::ssize_t>(triangles.size()), py::ssize_t{3}});
  std::int32_t* to = rows.mutable_data();
  for (const Triangle& t : triangles)
    for (const std::uint32_t vertex : t) *to++ = static_cast<std::int32_t>(vertex);
  return rows;
}

std::pair<py::array_t<double>, py::array_t<double>> arrays_of(const std::vector<Sphere>& spheres) {
  const auto count = static_cast<py::ssize_t>(spheres.size());
  py::array_t<double> centres({count, py::ssize_t{3}}), radii(count);
  double* centre = centres.mutable_data();
  double* radius = radii.mutable_data();
  for (const Sphere& sphere : spheres) {
    for (const double coordinate : {sphere.centre.x, sphere.centre.y, sphere.centre.z})
      *centre++ = coordinate;
    *radius++ = sphere.radius;
  }
  return {std::move(centres), std::move(radii)};
}

// What a command throws, and nothing but an Error for what should not happen.
cli::CalledResult run_unlocked(const cli::CalledCommand& command, const cli::Call& call, Monitor& monitor) {
  const py::gil_scoped_release unlock;
  try {
    return command.run(call, monitor);
  } catch (const Error&) {
    throw;
  } catch (const py::error_already_set&) {
    throw;
  } catch (const Jobs::Ending&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    throw FailureError(error.what(), "this should not happen: please report it with the options");
  }
}

// model: the file's name, or what the arrays are called, as the system has it
py::tuple run(const std::string& name, const py::bytes& model, const std::optional<Vertices>& vertices,
              const std::optional<Triangles>& triangles, const std::vector<py::bytes>& arguments,
              const py::object& progress) {
  const JobGuard guard;  // until nothing of it asks for the interpreter's lock any more
  std::optional<MeshArrays> arrays;
  if (vertices && triangles)
    arrays = {{vertices->data(), static_cast<std::size_t>(vertices->size())},
              {triangles->data(), static_cast<std::size_t>(triangles->size())}};
  cli::Call call{std::string(model), arrays ? &*arrays : nullptr, {}};
  call.arguments.reserve(arguments.size());
  for (const py::bytes& argument : arguments) call.arguments.emplace_back(argument);
  CallingMonitor monitor(progress);
  const cli::CalledResult result = run_unlocked(command_of(name), call, monitor);
  auto [centres, radii] = arrays_of(result.spheres);
  return py::make_tuple(result.report, centres, radii, rows_of(result.mesh.positions),
                        rows_of(result.mesh.triangles));
}

py::list options(const std::string& name) {
  py::list list;
  for (const cli::CalledOption& option : command_of(name).options())
    list.append(py::make_tuple(option.name, option.form.is_list, option.form.is_flag, option.form.may_be_off,
                               option.form.may_be_bare, option.value, option.description));
  return list;
}

// Names in messages may hold any bytes.
py::str text_of(std::string_view text) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
}

void raise_as_in_python(const Error& error) {
  const py::object made =
      py::module_::import("aerate._errors")
          .attr("error_of")(static_cast<int>(error.code()), text_of(error.what()), text_of(error.hint()));
  PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(made.ptr())), made.ptr());
}

}  // namespace
}  // namespace aerate

PYBIND11_MODULE(_core, module) {
  using aerate::Error;
  module.attr("version") = AERATE_VERSION;
  module.def("run", &aerate::run);
  module.def("options", &aerate::options);
  module.def(
      "end_jobs", [] { aerate::jobs()->end_all(); }, py::call_guard<py::gil_scoped_release>());
  module.def("forget_jobs",
             &aerate::forget_jobs);  // in a process that was forked from one that has the module
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(std::move(thrown));
    } catch (const Error& error) {
      aerate::raise_as_in_python(error);
    } catch (const aerate::Jobs::Ending&) {
      PyErr_SetNone(PyExc_SystemExit);  // which ends a thread without a word
    }
  });
}
