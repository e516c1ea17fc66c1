#include "runtime/jobs/engines.h"

#include "runtime/jobs/local.h"
#include "runtime/jobs/openjd.h"
#include "runtime/jobs/slurm.h"

#include <algorithm>

namespace fluidcarve {

const std::vector<FarmEngine>& farm_engines() {
    static const std::vector<FarmEngine> engines{
        {"local",
         "runs the steps as processes on this machine",
         "plain",
         false,
         {"--processes"},
         {},
         farm_locally},
        {"slurm",
         "writes batch scripts for Slurm",
         "plain",
         true,
         {"--output", "--submit"},
         slurm_refusal,
         farm_slurm},
        {"openjd",
         "writes a job bundle for Open Job Description, such as AWS Deadline Cloud takes",
         "openjd",
         true,
         {"--output", "--submit", "--no-chunk-extension"},
         openjd_refusal,
         farm_openjd}};
    return engines;
}

const FarmEngine* find_engine(const std::string& name) {
    const auto found = std::ranges::find(farm_engines(), name, &FarmEngine::name);
    return found == farm_engines().end() ? nullptr : &*found;
}

}  // namespace fluidcarve
