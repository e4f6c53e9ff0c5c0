// SPDX-License-Identifier: GPL-3.0-or-later
#include <doctest/doctest.h>

#include <atomic>
#include <cfenv>
#include <cmath>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/base/parallel.h"
#include "core/base/thread_pool.h"
#include "tests/support/allocations.h"

using namespace imomushi;

namespace {

/// What an exception of a chunk says.
struct ChunkFailed : std::runtime_error {
    explicit ChunkFailed(std::size_t c) : std::runtime_error("failed"), chunk(c) {}
    std::size_t chunk;
};

double work(std::size_t i) {
    double x = static_cast<double>(i);
    for (int k = 0; k < 200; ++k) x = std::sqrt(x + 1.0 / (1.0 + static_cast<double>(k)));
    return x;
}

}  // namespace

TEST_CASE("thread pool: each chunk of each of three thousand small loops is done once, and no loop allocates") {
    ThreadPool pool(4);
    CHECK(pool.threads() == 4);
    std::vector<std::atomic<int>> done(97);
    int bad = 0;
    for (int loop = 0; loop < 3000; ++loop) {
        const std::size_t count = static_cast<std::size_t>(loop * 31 % 97);
        for (auto& d : done) d = 0;
        const auto before = allocations();
        pool.run(count, [&](std::size_t i) { ++done[i]; });
        if (allocations() != before) ++bad;
        for (std::size_t i = 0; i < done.size(); ++i)
            if (done[i] != (i < count ? 1 : 0)) ++bad;
    }
    CHECK(bad == 0);
}

TEST_CASE("parallel for: every item is done once, by the same chunks and with the same bytes for any number of threads") {
    std::vector<double> expected;
    for (int threads : {1, 2, 7}) {
        std::vector<int> done(1001, 0);
        std::vector<double> value(1001);
        std::atomic<bool> aligned{true};
        parallelFor(threads, done.size(), 64, [&](std::size_t begin, std::size_t end) {
            if (begin % 64 != 0 || (end - begin != 64 && end != 1001)) aligned = false;
            double sum = 0.0;
            for (std::size_t i = begin; i < end; ++i) ++done[i], value[i] = sum += work(i);
        });
        CHECK(aligned);
        CHECK(std::accumulate(done.begin(), done.end(), 0) == 1001);
        CHECK(*std::max_element(done.begin(), done.end()) == 1);
        if (expected.empty()) expected = value;
        CHECK(value == expected);
    }
}

TEST_CASE("parallel for: loops allocate nothing, whatever their body holds") {
    std::vector<double> value(4096);
    double a = 1.0, b = 2.0, c = 3.0, d = 4.0;
    parallelFor(3, value.size(), 16, [&](std::size_t, std::size_t) {});  // starts the threads
    const auto before = allocations();
    for (int loop = 0; loop < 1000; ++loop)
        parallelFor(3, value.size(), 256, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) value[i] = a + b + c + d;
        });
    CHECK(allocations() == before);
}

TEST_CASE("thread pool: never more threads than asked for take part") {
    ThreadPool pool(7);
    for (int threads : {1, 2, 5}) {
        std::mutex guard;
        std::set<std::thread::id> seen;
        for (int loop = 0; loop < 50; ++loop) {
            pool.run(64, [&](std::size_t i) {
                work(i);
                const std::lock_guard lock(guard);
                seen.insert(std::this_thread::get_id());
            }, threads);
            CHECK(seen.size() <= static_cast<std::size_t>(threads));
            seen.clear();
        }
    }
}

TEST_CASE("thread pool: the exception of the first chunk that throws reaches the caller, the same for any number of threads") {
    for (int threads : {1, 2, 7}) {
        ThreadPool pool(threads);
        for (int round = 0; round < 200; ++round) {
            std::vector<std::atomic<int>> done(64);
            std::size_t failed = 0;
            try {
                pool.run(done.size(), [&](std::size_t i) {
                    ++done[i];
                    work(i);
                    if (i == 63 || i % 20 == 17) throw ChunkFailed(i);
                });
            } catch (const ChunkFailed& e) {
                failed = e.chunk;
            }
            CHECK(failed == 17);
            for (std::size_t i = 0; i <= 17; ++i) CHECK(done[i] == 1);
            for (std::size_t i = 18; i < done.size(); ++i) CHECK(done[i] <= 1);
        }
        std::atomic<int> sum{0};
        pool.run(100, [&](std::size_t) { ++sum; });
        CHECK(sum == 100);
    }
}

TEST_CASE("thread pool: a loop inside a loop runs on the thread of the outer one, and its exceptions reach the outermost caller") {
    ThreadPool pool(4);
    std::vector<std::atomic<int>> done(30 * 40);
    std::atomic<int> elsewhere{0};
    pool.run(30, [&](std::size_t i) {
        const auto here = std::this_thread::get_id();
        pool.run(40, [&](std::size_t k) {
            if (std::this_thread::get_id() != here) ++elsewhere;
            ++done[i * 40 + k];
        });
        parallelFor(4, 10, 1, [&](std::size_t, std::size_t) {
            if (std::this_thread::get_id() != here) ++elsewhere;
        });
    });
    CHECK(elsewhere == 0);
    for (const auto& d : done) CHECK(d == 1);
    CHECK_THROWS_AS(pool.run(30, [&](std::size_t i) { pool.run(2, [&](std::size_t) { if (i == 7) throw ChunkFailed(i); }); }), ChunkFailed);
}

TEST_CASE("thread pool: several threads run loops at the same time") {
    ThreadPool pool(3);
    std::atomic<int> bad{0};
    std::vector<std::jthread> callers;
    for (int caller = 0; caller < 12; ++caller)  // more than there is room for loops
        callers.emplace_back([&, caller] {
            for (int loop = 0; loop < 300; ++loop) {
                std::vector<int> done(50, 0);
                bool thrown = false;
                try {
                    pool.run(done.size(), [&](std::size_t i) {
                        done[i] = caller + 1;
                        if (loop % 10 == 9 && i == 49) throw ChunkFailed(i);
                    });
                } catch (const ChunkFailed&) {
                    thrown = true;
                }
                if (thrown != (loop % 10 == 9) || std::count(done.begin(), done.end(), caller + 1) != 50) ++bad;
            }
        });
    callers.clear();
    CHECK(bad == 0);
}

TEST_CASE("thread pool: workers round as the caller does") {
    ThreadPool pool(4);
    const int before = std::fegetround();
    for (const int rounding : {FE_UPWARD, FE_DOWNWARD, FE_TONEAREST}) {
        std::fesetround(rounding);
        std::atomic<int> other{0};
        pool.run(200, [&](std::size_t i) {
            work(i);
            if (std::fegetround() != rounding) ++other;
        });
        std::fesetround(before);
        CHECK(other == 0);
    }
}

TEST_CASE("thread pool: those who want the same number of threads share a pool while one of them lives") {
    const auto a = ThreadPool::shared(3), b = ThreadPool::shared(3), c = ThreadPool::shared(2);
    CHECK(a == b);
    CHECK(a != c);
    CHECK(a->threads() == 3);
    CHECK(c->threads() == 2);
}
