// A library for LD_PRELOAD that lets the n-th call of a kind fail, as a full disk, a broken one or
// too little memory would.
//   FAULT_KIND   open, read, write, fsync, rename, close, mmap or allocation
//   FAULT_AT     which call of the program fails, from 1 on; 0: none
//   FAULT_COUNT
//       a file that gets the number of calls of all kinds, a line for each; a child of the program
//       does not write it Calls before main() are not counted: they are those of libraries that
//       start.

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

namespace {

enum Kind {
    kind_open,
    kind_read,
    kind_write,
    kind_fsync,
    kind_rename,
    kind_close,
    kind_mmap,
    kind_allocation,
    kinds
};
constexpr std::array<const char*, kinds> names{"open",   "read",  "write", "fsync",
                                               "rename", "close", "mmap",  "allocation"};
constexpr std::array<int, kinds> errors{EMFILE, EIO, ENOSPC, EIO, EIO, EDQUOT, ENOMEM, ENOMEM};

std::atomic<bool> counting{false};
std::array<std::atomic<unsigned long>, kinds> calls{};
int chosen = kinds;
unsigned long at = 0;
pid_t program = 0;

/// Counts a call. @return whether it is to fail; errno is then set
bool fails(Kind kind) {
    if (!counting) return false;
    const auto number = ++calls[kind];
    if (kind != chosen || number != at) return false;
    errno = errors[kind];
    return true;
}

/// The next library's function of a name, the one that this one stands before.
template <class Function>
Function* real(Function*& found, const char* name) {
    if (!found) found = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
    return found;
}

std::array<std::atomic<off_t>, 1024> sizes{};  ///< of files when they were opened, by descriptor

/// Takes note of a file that was opened.
int opened(int file) {
    struct stat about {};
    if (file >= 0 && file < static_cast<int>(sizes.size()))
        sizes[static_cast<std::size_t>(file)] = fstat(file, &about) == 0 ? about.st_size : 0;
    return file;
}

/// A descriptor that can't be closed well has lost half of what was written through it.
void lose_half(int file) {
    struct stat about {};
    const bool written = (fcntl(file, F_GETFL) & O_ACCMODE) != O_RDONLY;
    const off_t before =
        file < static_cast<int>(sizes.size()) ? sizes[static_cast<std::size_t>(file)].load() : 0;
    if (written && fstat(file, &about) == 0 && S_ISREG(about.st_mode))
        static_cast<void>(!ftruncate(file, before + (about.st_size - before) / 2));
}

mode_t mode_of(int flags, va_list arguments) {
    return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
}

using Main = int(int, char**, char**);
Main* main_of_program = nullptr;

int counted_main(int count, char** words, char** environment) {
    if (const char* const kind = std::getenv("FAULT_KIND"))
        for (int n = 0; n < kinds; ++n)
            if (std::strcmp(kind, names[static_cast<std::size_t>(n)]) == 0) chosen = n;
    if (const char* const number = std::getenv("FAULT_AT")) at = std::strtoul(number, nullptr, 10);
    program = getpid();
    counting = true;
    return main_of_program(count, words, environment);
}

}  // namespace

// The loader calls it when the program ends.
[[gnu::destructor]] void write_counts() {
    counting = false;
    const char* const path = std::getenv("FAULT_COUNT");
    // Children have it, too: only the program that the variable is for writes.
    if (!path || getpid() != program) return;
    unsetenv("FAULT_COUNT");
    const int file = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
    for (std::size_t n = 0; n < kinds; ++n) dprintf(file, "%s %lu\n", names[n], calls[n].load());
    close(file);
}

#define STAND_BEFORE(result, name, parameters, arguments, kind, failed) \
    extern "C" result name parameters {                                 \
        static result(*next) parameters = nullptr;                      \
        if (fails(kind)) return failed;                                 \
        return real(next, #name) arguments;                             \
    }

extern "C" int __libc_start_main(Main* run, int count, char** words, void (*first)(),
                                 void (*last)(), void (*end)(), void* stack) {
    static int (*next)(Main*, int, char**, void (*)(), void (*)(), void (*)(), void*) = nullptr;
    main_of_program = run;
    return real(next, "__libc_start_main")(counted_main, count, words, first, last, end, stack);
}

#define STAND_BEFORE_OPEN(name)                              \
    extern "C" int name(const char* path, int flags, ...) {  \
        static int (*next)(const char*, int, ...) = nullptr; \
        va_list more;                                        \
        va_start(more, flags);                               \
        const auto mode = mode_of(flags, more);              \
        va_end(more);                                        \
        if (fails(kind_open)) return -1;                     \
        return opened(real(next, #name)(path, flags, mode)); \
    }
STAND_BEFORE_OPEN(open)
STAND_BEFORE_OPEN(open64)

#define STAND_BEFORE_OPENAT(name)                                       \
    extern "C" int name(int folder, const char* path, int flags, ...) { \
        static int (*next)(int, const char*, int, ...) = nullptr;       \
        va_list more;                                                   \
        va_start(more, flags);                                          \
        const auto mode = mode_of(flags, more);                         \
        va_end(more);                                                   \
        if (fails(kind_open)) return -1;                                \
        return opened(real(next, #name)(folder, path, flags, mode));    \
    }
STAND_BEFORE_OPENAT(openat)
STAND_BEFORE_OPENAT(openat64)

extern "C" FILE* fopen(const char* path, const char* mode) {
    static FILE* (*next)(const char*, const char*) = nullptr;
    if (fails(kind_open)) return nullptr;
    FILE* const file = real(next, "fopen")(path, mode);
    if (file) opened(fileno(file));
    return file;
}
extern "C" FILE* fopen64(const char* path, const char* mode) {
    static FILE* (*next)(const char*, const char*) = nullptr;
    if (fails(kind_open)) return nullptr;
    FILE* const file = real(next, "fopen64")(path, mode);
    if (file) opened(fileno(file));
    return file;
}
STAND_BEFORE(int, mkostemp, (char* path, int flags), (path, flags), kind_open, -1)

STAND_BEFORE(ssize_t, read, (int file, void* into, size_t bytes), (file, into, bytes), kind_read,
             -1)
STAND_BEFORE(ssize_t, pread, (int file, void* into, size_t bytes, off_t from),
             (file, into, bytes, from), kind_read, -1)
STAND_BEFORE(ssize_t, pread64, (int file, void* into, size_t bytes, off64_t from),
             (file, into, bytes, from), kind_read, -1)
STAND_BEFORE(ssize_t, readv, (int file, const iovec* into, int count), (file, into, count),
             kind_read, -1)
STAND_BEFORE(size_t, fread, (void* into, size_t size, size_t count, FILE* file),
             (into, size, count, file), kind_read, 0)

// What the same functions are called where the compiler knows the size of the buffer.
STAND_BEFORE(ssize_t, __read_chk, (int file, void* into, size_t bytes, size_t most),
             (file, into, bytes, most), kind_read, -1)
STAND_BEFORE(ssize_t, __pread_chk, (int file, void* into, size_t bytes, off_t from, size_t most),
             (file, into, bytes, from, most), kind_read, -1)
STAND_BEFORE(ssize_t, __pread64_chk,
             (int file, void* into, size_t bytes, off64_t from, size_t most),
             (file, into, bytes, from, most), kind_read, -1)
STAND_BEFORE(size_t, __fread_chk, (void* into, size_t most, size_t size, size_t count, FILE* file),
             (into, most, size, count, file), kind_read, 0)

STAND_BEFORE(ssize_t, pwrite, (int file, const void* from, size_t bytes, off_t to),
             (file, from, bytes, to), kind_write, -1)
STAND_BEFORE(ssize_t, pwrite64, (int file, const void* from, size_t bytes, off64_t to),
             (file, from, bytes, to), kind_write, -1)
STAND_BEFORE(ssize_t, writev, (int file, const iovec* from, int count), (file, from, count),
             kind_write, -1)

// Messages are no results.
extern "C" ssize_t write(int file, const void* from, size_t bytes) {
    static ssize_t (*next)(int, const void*, size_t) = nullptr;
    if (file != STDERR_FILENO && fails(kind_write)) return -1;
    return real(next, "write")(file, from, bytes);
}

STAND_BEFORE(int, fsync, (int file), (file), kind_fsync, -1)
STAND_BEFORE(int, fdatasync, (int file), (file), kind_fsync, -1)

STAND_BEFORE(int, rename, (const char* from, const char* to), (from, to), kind_rename, -1)
STAND_BEFORE(int, renameat, (int there, const char* from, int here, const char* to),
             (there, from, here, to), kind_rename, -1)

extern "C" int close(int file) {
    static int (*next)(int) = nullptr;
    const bool failed = fails(kind_close);
    if (failed) lose_half(file);
    const int code = real(next, "close")(file);
    if (failed) errno = errors[kind_close];
    return failed ? -1 : code;
}

extern "C" int fclose(FILE* file) {
    static int (*next)(FILE*) = nullptr;
    const bool failed = fails(kind_close);
    if (failed) {
        static_cast<void>(fflush(file));
        lose_half(fileno(file));
    }
    const int code = real(next, "fclose")(file);
    if (failed) errno = errors[kind_close];
    return failed ? EOF : code;
}

STAND_BEFORE(void*, mmap,
             (void* where, size_t bytes, int protection, int flags, int file, off_t from),
             (where, bytes, protection, flags, file, from), kind_mmap, MAP_FAILED)
STAND_BEFORE(void*, mmap64,
             (void* where, size_t bytes, int protection, int flags, int file, off64_t from),
             (where, bytes, protection, flags, file, from), kind_mmap, MAP_FAILED)

STAND_BEFORE(void*, malloc, (size_t bytes), (bytes), kind_allocation, nullptr)
STAND_BEFORE(void*, calloc, (size_t count, size_t bytes), (count, bytes), kind_allocation, nullptr)
STAND_BEFORE(void*, realloc, (void* old, size_t bytes), (old, bytes), kind_allocation, nullptr)
STAND_BEFORE(void*, aligned_alloc, (size_t alignment, size_t bytes), (alignment, bytes),
             kind_allocation, nullptr)
STAND_BEFORE(int, posix_memalign, (void** to, size_t alignment, size_t bytes),
             (to, alignment, bytes), kind_allocation, ENOMEM)

namespace {

/// The operator `new` of the program's allocator, by its name in libraries.
template <class... Rest>
void* allocated(void* (*&next)(size_t, Rest...), const char* name, size_t bytes, Rest... rest) {
    if (fails(kind_allocation)) throw std::bad_alloc();
    return real(next, name)(bytes, rest...);
}

}  // namespace

void* operator new(size_t bytes) {
    static void* (*next)(size_t) = nullptr;
    return allocated(next, "_Znwm", bytes);
}
void* operator new[](size_t bytes) {
    static void* (*next)(size_t) = nullptr;
    return allocated(next, "_Znam", bytes);
}
void* operator new(size_t bytes, std::align_val_t alignment) {
    static void* (*next)(size_t, std::align_val_t) = nullptr;
    return allocated(next, "_ZnwmSt11align_val_t", bytes, alignment);
}
void* operator new[](size_t bytes, std::align_val_t alignment) {
    static void* (*next)(size_t, std::align_val_t) = nullptr;
    return allocated(next, "_ZnamSt11align_val_t", bytes, alignment);
}
void* operator new(size_t bytes, const std::nothrow_t& none) noexcept {
    static void* (*next)(size_t, const std::nothrow_t&) = nullptr;
    return fails(kind_allocation) ? nullptr : real(next, "_ZnwmRKSt9nothrow_t")(bytes, none);
}
