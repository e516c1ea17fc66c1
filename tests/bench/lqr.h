#pragma once

/// Narrows a picture of 1920 x 1080 to 1536 by seam.dynamic and by liblqr: time, and energy of all
/// that is removed.
void bench_lqr();
