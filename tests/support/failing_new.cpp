// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/failing_new.h"

#include <dlfcn.h>
#include <execinfo.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

std::atomic<long> left{0};  // requests until one fails; 0 and less: it has failed, or none will
std::atomic<bool> armed{false}, goesOn{false}, onThisThread{false};
thread_local bool mine = false;  // the thread that asked for failures

const void* programOf(const void* address) {
    Dl_info found;
    return ::dladdr(address, &found) ? found.dli_fbase : nullptr;
}

/// The program itself asks, not a library: templates of the standard library and of Qt are compiled into the program. `asker`: to where operator new returns.
bool ownCode(const void* asker) {
    static const void* const program = programOf(reinterpret_cast<const void*>(&ownCode));
    std::array<void*, 32> callers{};
    const int count = ::backtrace(callers.data(), static_cast<int>(callers.size()));
    bool asked = false, own = false;
    for (int i = 0; i < count; ++i) {
        const void* address = callers[static_cast<std::size_t>(i)];
        asked = asked || address == asker;
        Dl_info caller;
        if (!asked || !::dladdr(address, &caller)) continue;
        // Destructors of nlohmann's JSON ask for memory.
        if (caller.dli_sname && std::strstr(caller.dli_sname, "json_value7destroy")) return false;
        if (own) continue;
        own = caller.dli_fbase == program;
        if (!own && !(caller.dli_fname && std::strstr(caller.dli_fname, "libstdc++"))) return false;
    }
    return own;
}

bool failsNow(const void* asker) {
    if (!armed.load(std::memory_order_relaxed) || mine != onThisThread.load(std::memory_order_relaxed)) return false;
    const long before = left.load(std::memory_order_relaxed) > 0 ? left.fetch_sub(1) : 0;
    if (before > 1 || (before <= 0 && !goesOn)) return false;
    if (ownCode(asker)) return true;
    if (before == 1) left = 1;  // the next one
    return false;
}

void* orNull(std::size_t size, std::size_t alignment, const void* asker) noexcept {
    if (failsNow(asker)) return nullptr;
    const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
    return alignment > alignof(std::max_align_t) ? std::aligned_alloc(alignment, rounded) : std::malloc(size ? size : 1);
}

void* orThrow(std::size_t size, std::size_t alignment, const void* asker) {
    void* memory = orNull(size, alignment, asker);
    if (!memory) throw std::bad_alloc();
    return memory;
}

}  // namespace

namespace imomushi {

FailingNew::FailingNew(On threads, long n, Fails fails) {
    ownCode(nullptr);  // asks for memory itself the first time
    mine = true;
    onThisThread = threads == On::ThisThread;
    goesOn = fails == Fails::FromThenOn;
    left = n;
    armed = true;
}
FailingNew::~FailingNew() {
    armed = false;
    mine = false;
}
bool FailingNew::failed() { return left <= 0; }

}  // namespace imomushi

void* operator new(std::size_t size) { return orThrow(size, 1, __builtin_return_address(0)); }
void* operator new[](std::size_t size) { return orThrow(size, 1, __builtin_return_address(0)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
    return orThrow(size, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return orThrow(size, static_cast<std::size_t>(alignment), __builtin_return_address(0));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return orNull(size, 1, __builtin_return_address(0)); }
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept { return orNull(size, 1, __builtin_return_address(0)); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete[](void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
