#pragma once

#include <string>

/// The paper's figure 14: what is removed from images, and what is left of them, by solver, with
/// backward and with forward costs. Takes all PNG files of a folder; prints a summary, and writes
/// `OUT.csv` and `OUT.png`. Means over the images.
/// @param seams  from each image, 100 in the paper; fewer if an image is too narrow
void compare_on_images(const std::string& folder, const std::string& out, int seams);
