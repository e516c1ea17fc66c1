// jemalloc, in place of the C library's allocator: frames come and go in thousands of small pieces,
// from all threads.

extern "C" {
extern const char* malloc_conf;
/// jemalloc's settings. Huge pages: where the system grants them, a new frame costs a few page
/// faults, not thousands.
const char* malloc_conf = "thp:always,metadata_thp:always";
}
