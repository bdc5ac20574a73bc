// SPDX-License-Identifier: Apache-2.0
// Replaces malloc and related functions in the executable, counts each call, and forwards it to glibc.
// operator new and delete are counted too, because libstdc++ builds them on malloc and free.
#include <cerrno>
#include <cstddef>

#include "fovea/linux_rt/heap_counter.hpp"

extern "C" {

// glibc's own allocator, under its names for interposers.
void* __libc_malloc(std::size_t size);
void __libc_free(void* block);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  fovea::linux_rt::NoteHeapCall();
  return __libc_malloc(size);
}

void free(void* block) {
  if (block != nullptr) {
    fovea::linux_rt::NoteHeapCall();
  }
  __libc_free(block);
}

void* calloc(std::size_t count, std::size_t size) {
  fovea::linux_rt::NoteHeapCall();
  return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) {
  fovea::linux_rt::NoteHeapCall();
  return __libc_realloc(block, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
  fovea::linux_rt::NoteHeapCall();
  return __libc_memalign(alignment, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
  fovea::linux_rt::NoteHeapCall();
  return __libc_memalign(alignment, size);
}

int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  fovea::linux_rt::NoteHeapCall();
  if (alignment < sizeof(void*) || (alignment & (alignment - 1)) != 0) {
    return EINVAL;
  }
  void* const block = __libc_memalign(alignment, size);
  if (block == nullptr) {
    return ENOMEM;
  }
  *out = block;
  return 0;
}

}  // extern "C"
