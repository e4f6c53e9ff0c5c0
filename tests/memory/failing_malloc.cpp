// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/memory/failing_malloc.h"

#include <dlfcn.h>
#include <execinfo.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstring>

namespace {

std::atomic<long> left{0};        // requests until one fails; 0 and less: it has failed, or none will
std::atomic<bool> goesOn{false};  // all after it fail too

/// What libraries cannot survive: destructors of nlohmann's JSON ask for memory (for a stack instead of recursion), and what makes an object or an array of null there
/// does it in two steps; libstdc++ reads folders in functions that are noexcept; libgomp, which CHOLMOD uses, ends the program.
bool isDeadly(const Dl_info& where) {
    if (where.dli_fname && std::strstr(where.dli_fname, "libgomp")) return true;
    const char* const caller = where.dli_sname;
    if (!caller) return false;
    if (std::strstr(caller, "18directory_iterator")) return true;
    if (!std::strstr(caller, "basic_json") || std::strncmp(caller, "_ZN8nlohmann", 12) != 0) return false;
    return std::strstr(caller, "json_value7destroy") || std::strstr(caller, "EEix") || std::strstr(caller, "EE9push_back");
}

bool deadlyNow() {
    std::array<void*, 48> callers{};
    const int count = ::backtrace(callers.data(), static_cast<int>(callers.size()));
    for (int i = 0; i < count; ++i) {
        Dl_info caller;
        if (::dladdr(callers[static_cast<std::size_t>(i)], &caller) && isDeadly(caller)) return true;
    }
    return false;
}

bool failsNow() {
    const long before = left.load(std::memory_order_relaxed) > 0 ? left.fetch_sub(1) : 0;
    if (before > 1 || (before <= 0 && !goesOn.load(std::memory_order_relaxed))) return false;
    if (!deadlyNow()) return true;
    if (before == 1 && !goesOn) left = 1;  // the next one
    return false;
}

}  // namespace

namespace imomushi {

FailingMalloc::FailingMalloc(long n, Fails fails) {
    deadlyNow();  // asks for memory itself the first time
    left = n;
    goesOn = fails == Fails::FromThenOn;
}
FailingMalloc::~FailingMalloc() {
    goesOn = false;
    left = 0;
}
bool FailingMalloc::failed() { return left <= 0; }

}  // namespace imomushi

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
bool imomushi::FailingMalloc::works() { return false; }
#else
bool imomushi::FailingMalloc::works() { return true; }

// glibc lets a program bring its own malloc, and keeps its own under these names.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);

static void* noMemory() {
    errno = ENOMEM;
    return nullptr;
}

void* malloc(std::size_t size) { return failsNow() ? noMemory() : __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) { return failsNow() ? noMemory() : __libc_calloc(count, size); }
void* realloc(void* old, std::size_t size) { return failsNow() ? noMemory() : __libc_realloc(old, size); }
void* memalign(std::size_t alignment, std::size_t size) { return failsNow() ? noMemory() : __libc_memalign(alignment, size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) { return memalign(alignment, size); }
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
    if (failsNow()) return ENOMEM;
    *memory = __libc_memalign(alignment, size);
    return *memory ? 0 : ENOMEM;
}
}
#endif
