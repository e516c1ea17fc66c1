#pragma once

/// How long the page of preview.page takes from its slider to the picture, beside the 50 ms in
/// which a hand feels no delay.
void bench_page();
