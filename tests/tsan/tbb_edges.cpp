// For builds with ThreadSanitizer. oneTBB's library is not built with it, so it does not see that a task begins
// after it was spawned, that a loop returns after its tasks have ended, and that memory of a task is taken after
// it was given back: all that tasks share would look like a race. oneTBB's headers call these functions of the
// library (with TBB_USE_PROFILING_TOOLS); these here take their place, tell ThreadSanitizer, and go on to them.
#include <dlfcn.h>
#include <memory>
#include <oneapi/tbb/detail/_small_object_pool.h>
#include <oneapi/tbb/detail/_task.h>

extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);

namespace tbb::detail {
namespace {

// The function of the library, by its name there.
template <typename Function>
Function* library(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

// Stands in for a task that was spawned, and is what happened before it.
class SpawnedTask final : public d1::task {
 public:
  explicit SpawnedTask(d1::task& task) : task_(task) { __tsan_release(this); }

  d1::task* execute(d1::execution_data& data) override {
    __tsan_acquire(this);
    d1::task* const following = task_.execute(data);  // `cancel` is called after an exception
    delete this;
    return following;
  }

  d1::task* cancel(d1::execution_data& data) override {
    __tsan_acquire(this);
    const std::unique_ptr<SpawnedTask> self(this);
    return task_.cancel(data);
  }

 private:
  d1::task& task_;
};

void* taken(void* memory) {
  __tsan_acquire(memory);
  return memory;
}

}  // namespace

namespace r1 {

void spawn(d1::task& task, d1::task_group_context& context) {
  static auto* const kSpawn = library<void(d1::task&, d1::task_group_context&)>(
      "_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextE");
  kSpawn(*new SpawnedTask(task), context);
}

void spawn(d1::task& task, d1::task_group_context& context, d1::slot_id slot) {
  static auto* const kSpawn = library<void(d1::task&, d1::task_group_context&, d1::slot_id)>(
      "_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextEt");
  kSpawn(*new SpawnedTask(task), context, slot);
}

// What is waited for is released by each task that ends, and acquired by who waited.
void call_itt_notify(int kind, void* address) {
  if (kind == d1::releasing) __tsan_release(address);
  if (kind == d1::acquired) __tsan_acquire(address);
}

void* allocate(d1::small_object_pool*& pool, std::size_t bytes) {
  static auto* const kAllocate = library<void*(d1::small_object_pool*&, std::size_t)>(
      "_ZN3tbb6detail2r18allocateERPNS0_2d117small_object_poolEm");
  return taken(kAllocate(pool, bytes));
}

void* allocate(d1::small_object_pool*& pool, std::size_t bytes, const d1::execution_data& data) {
  static auto* const kAllocate =
      library<void*(d1::small_object_pool*&, std::size_t, const d1::execution_data&)>(
          "_ZN3tbb6detail2r18allocateERPNS0_2d117small_object_poolEmRKNS2_14execution_dataE");
  return taken(kAllocate(pool, bytes, data));
}

void deallocate(d1::small_object_pool& pool, void* memory, std::size_t bytes) {
  static auto* const kDeallocate = library<void(d1::small_object_pool&, void*, std::size_t)>(
      "_ZN3tbb6detail2r110deallocateERNS0_2d117small_object_poolEPvm");
  __tsan_release(memory);
  kDeallocate(pool, memory, bytes);
}

void deallocate(d1::small_object_pool& pool, void* memory, std::size_t bytes,
                const d1::execution_data& data) {
  static auto* const kDeallocate =
      library<void(d1::small_object_pool&, void*, std::size_t, const d1::execution_data&)>(
          "_ZN3tbb6detail2r110deallocateERNS0_2d117small_object_poolEPvmRKNS2_14execution_dataE");
  __tsan_release(memory);
  kDeallocate(pool, memory, bytes, data);
}

}  // namespace r1
}  // namespace tbb::detail
