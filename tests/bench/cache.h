#pragma once

/// What the work folder costs and saves: a first run with it against one without, a second run,
/// reading and hashing files.
void bench_cache();
