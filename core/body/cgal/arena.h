// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <new>

// Of the .cpp files of this folder alone.
namespace imomushi::cgal {

/// A bump allocator of this thread: addresses ascend in the order of requests. Its destructor gives all memory back, nothing before.
class Arena {
public:
    explicit Arena(std::size_t bytes) : memory_(std::make_unique_for_overwrite<std::byte[]>(bytes)), next_(memory_.get()), end_(next_ + bytes), outer_(current()) { current() = this; }
    ~Arena() { current() = outer_; }
    Arena(const Arena&) = delete;
    Arena& operator=(const Arena&) = delete;

    /// Throws std::bad_alloc where it is full.
    void* allocate(std::size_t bytes, std::size_t alignment) {
        void* at = next_;
        std::size_t left = static_cast<std::size_t>(end_ - next_);
        if (!std::align(alignment, bytes, at, left)) throw std::bad_alloc();
        next_ = static_cast<std::byte*>(at) + bytes;
        return at;
    }
    [[nodiscard]] bool holds(const void* p) const { return !std::less<const void*>()(p, memory_.get()) && std::less<const void*>()(p, end_); }

    static Arena*& current() {
        thread_local Arena* arena = nullptr;
        return arena;
    }

private:
    std::unique_ptr<std::byte[]> memory_;
    std::byte *next_, *end_;
    Arena* outer_;
};

/// Takes from the arena of this thread, without one from the heap.
template <class T>
struct ArenaAllocator {
    using value_type = T;
    ArenaAllocator() = default;
    template <class U>
    ArenaAllocator(const ArenaAllocator<U>&) {}
    T* allocate(std::size_t n) {
        if (Arena* arena = Arena::current()) return static_cast<T*>(arena->allocate(n * sizeof(T), alignof(T)));
        return std::allocator<T>().allocate(n);
    }
    void deallocate(T* p, std::size_t n) {
        if (const Arena* arena = Arena::current(); arena && arena->holds(p)) return;
        std::allocator<T>().deallocate(p, n);
    }
    bool operator==(const ArenaAllocator&) const { return true; }
};

}  // namespace imomushi::cgal
