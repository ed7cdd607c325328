// For builds with ThreadSanitizer. oneTBB's library is not built with it, so it does not see that a task begins
// after it was spawned, that a loop returns after its tasks have ended, and that memory of a task is taken after
// it was given back: all that tasks share would look like a race. oneTBB's headers call these functions of the
// library (with TBB_USE_PROFILING_TOOLS); these here take their place, tell ThreadSanitizer, and go on to them.
#include <dlfcn.h>
#include <memory>
#include <oneapi/tbb/detail/_small_object_pool.h>
#include <oneapi/tbb/detail/_task.h>
#include <oneapi/tbb/parallel_pipeline.h>

extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);

namespace tbb::detail {
namespace {

// The function of the library, by its name there.
template <typename Function>
Function* library(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

// Stands in for a task that was spawned, and is what happened before it. Who waits in the task's context sees that it
// has ended even where its loop was compiled into a library that does not say so.
class SpawnedTask final : public d1::task {
 public:
  SpawnedTask(d1::task& task, d1::task_group_context& context) : task_(task), context_(&context) {
    __tsan_release(this);
  }

  d1::task* execute(d1::execution_data& data) override {
    __tsan_acquire(this);
    d1::task* const following = task_.execute(data);  // `cancel` is called after an exception
    __tsan_release(context_);
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
  void* context_;  // may be gone by the time the task has ended
};

// Stands in for a filter of a pipeline: what a filter did happens before what the next call of any filter does.
class SeenFilter final : public d1::base_filter {
 public:
  SeenFilter(d1::base_filter* filter, void* pipeline)
      : base_filter(mode_of(*filter)), filter_(filter), pipeline_(pipeline) {}

  void* operator()(void* item) override {
    __tsan_acquire(pipeline_);
    running = this;
    void* const result = (*filter_)(item);
    __tsan_release(pipeline_);
    return result;
  }

  SeenFilter(const SeenFilter&) = delete;
  SeenFilter& operator=(const SeenFilter&) = delete;

  ~SeenFilter() override {
    filter_->~base_filter();
    r1::deallocate_memory(filter_);
  }

  void finalize(void* item) override { filter_->finalize(item); }

  static thread_local SeenFilter* running;

 private:
  static unsigned mode_of(d1::base_filter& filter) {
    unsigned mode = filter.is_serial() ? filter_is_serial : 0;
    if (!filter.is_ordered()) mode |= filter_is_out_of_order;
    if (filter.object_may_be_null()) mode |= filter_may_emit_null;
    return mode;
  }

  d1::base_filter* filter_;
  void* pipeline_;
};

thread_local SeenFilter* SeenFilter::running = nullptr;

// Memory of filters, and of nodes that others point to, is given back by the library.
class SeenNode final : public d1::filter_node {
 public:
  SeenNode(const d1::filter_node& node, void* pipeline) : node_(node), pipeline_(pipeline) {
    if (!node.left || !node.right) return;
    left = make(*node.left, pipeline);
    right = make(*node.right, pipeline);
  }

  d1::base_filter* create_filter() const override {
    return new (r1::allocate_memory(sizeof(SeenFilter))) SeenFilter(node_.create_filter(), pipeline_);
  }

 private:
  static SeenNode* make(const d1::filter_node& node, void* pipeline) {
    return new (r1::allocate_memory(sizeof(SeenNode))) SeenNode(node, pipeline);
  }

  const d1::filter_node& node_;
  void* pipeline_;
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
  kSpawn(*new SpawnedTask(task, context), context);
}

void spawn(d1::task& task, d1::task_group_context& context, d1::slot_id slot) {
  static auto* const kSpawn = library<void(d1::task&, d1::task_group_context&, d1::slot_id)>(
      "_ZN3tbb6detail2r15spawnERNS0_2d14taskERNS2_18task_group_contextEt");
  kSpawn(*new SpawnedTask(task, context), context, slot);
}

void execute_and_wait(d1::task& task, d1::task_group_context& context, d1::wait_context& waited,
                      d1::task_group_context& of_wait) {
  using Wait = void(d1::task&, d1::task_group_context&, d1::wait_context&, d1::task_group_context&);
  static auto* const kWait = library<Wait>(
      "_ZN3tbb6detail2r116execute_and_waitERNS0_2d14taskERNS2_18task_group_contextERNS2_12wait_contextES6_");
  kWait(task, context, waited, of_wait);
  __tsan_acquire(&context);
}

void wait(d1::wait_context& waited, d1::task_group_context& context) {
  static auto* const kWait = library<void(d1::wait_context&, d1::task_group_context&)>(
      "_ZN3tbb6detail2r14waitERNS0_2d112wait_contextERNS2_18task_group_contextE");
  kWait(waited, context);
  __tsan_acquire(&context);
}

void parallel_pipeline(d1::task_group_context& context, std::size_t tokens, const d1::filter_node& filters) {
  static auto* const kPipeline = library<void(d1::task_group_context&, std::size_t, const d1::filter_node&)>(
      "_ZN3tbb6detail2r117parallel_pipelineERNS0_2d118task_group_contextEmRKNS2_11filter_nodeE");
  char pipeline = 0;
  __tsan_release(&pipeline);
  kPipeline(context, tokens, SeenNode(filters, &pipeline));
  __tsan_acquire(&pipeline);
}

void set_end_of_input(d1::base_filter&) {
  static auto* const kEnd =
      library<void(d1::base_filter&)>("_ZN3tbb6detail2r116set_end_of_inputERNS0_2d111base_filterE");
  kEnd(*SeenFilter::running);
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
