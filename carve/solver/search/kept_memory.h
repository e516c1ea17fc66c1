#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

namespace fluidcarve {

/// Memory that one search passes on to the next. Fresh memory costs a page fault for each page: a
/// quarter of the time of a large search.
class KeptMemory {
public:
    /// An uninitialised array. Its memory returns to the KeptMemory that it came from.
    template <class T>
    class Array {
    public:
        Array(Array&&) = default;
        Array& operator=(Array&&) = default;
        std::size_t size() const { return size_; }
        T* data() { return static_cast<T*>(block_.get()); }
        const T* data() const { return static_cast<const T*>(block_.get()); }
        T& operator[](std::size_t n) { return data()[n]; }
        const T& operator[](std::size_t n) const { return data()[n]; }

    private:
        friend class KeptMemory;
        Array(std::shared_ptr<void> block, std::size_t size)
            : block_(std::move(block)), size_(size) {}

        std::shared_ptr<void> block_;
        std::size_t size_;
    };

    /// @throws std::bad_alloc
    template <class T>
    Array<T> array(std::size_t size) const {
        static_assert(std::is_trivially_destructible_v<T> && std::is_trivially_copyable_v<T> &&
                      alignof(T) <= alignment);
        return {block(size * sizeof(T)), size};
    }

private:
    static constexpr std::size_t alignment = 64;
    struct Free {
        void operator()(void* data) const { ::operator delete(data, std::align_val_t(alignment)); }
    };
    struct Block {
        std::size_t bytes;
        std::unique_ptr<void, Free> data;
    };
    struct Blocks {
        std::mutex mutex;
        std::vector<Block> free;
    };

    /// The smallest free block that fits, or a new one.
    std::shared_ptr<void> block(std::size_t bytes) const {
        Block out{bytes, nullptr};
        {
            const std::lock_guard lock(blocks_->mutex);
            auto& free = blocks_->free;
            auto best = free.end();
            for (auto each = free.begin(); each != free.end(); ++each)
                if (each->bytes >= bytes && each->bytes / 2 <= bytes &&
                    (best == free.end() || each->bytes < best->bytes))
                    best = each;
            if (best != free.end()) {
                out = std::move(*best);
                free.erase(best);
            }
        }
        if (!out.data) out.data.reset(::operator new(bytes, std::align_val_t(alignment)));
        return {out.data.release(), [kept = std::weak_ptr(blocks_), size = out.bytes](void* data) {
                    Block block{size, std::unique_ptr<void, Free>(data)};
                    const auto blocks = kept.lock();
                    if (!blocks) return;
                    const std::lock_guard lock(blocks->mutex);
                    blocks->free.push_back(std::move(block));
                }};
    }

    std::shared_ptr<Blocks> blocks_ = std::make_shared<Blocks>();
};

}  // namespace fluidcarve
