#include "runtime/jobs/engines.h"

#include "carve/base/find_or_null.h"
#include "runtime/jobs/local.h"
#include "runtime/jobs/openjd.h"
#include "runtime/jobs/slurm.h"

namespace fluidcarve {

const std::vector<FarmEngine>& farm_engines() {
    static const std::vector<FarmEngine> engines{
        {.name = "local",
         .doc = "runs the steps as processes on this machine",
         .progress = "plain",
         .options = {"--processes"},
         .refusal = {},
         .farm = farm_locally},
        {.name = "slurm",
         .doc = "writes batch scripts for Slurm",
         .progress = "plain",
         .other_machines = true,
         .options = {"--output", "--submit"},
         .refusal = slurm_refusal,
         .farm = farm_slurm},
        {.name = "openjd",
         .doc = "writes a job bundle for Open Job Description, such as AWS Deadline Cloud takes",
         .progress = "openjd",
         .other_machines = true,
         .options = {"--output", "--submit", "--no-chunk-extension"},
         .refusal = openjd_refusal,
         .farm = farm_openjd}};
    return engines;
}

const FarmEngine* find_engine(const std::string& name) {
    return find_or_null(farm_engines(), name, &FarmEngine::name);
}

}  // namespace fluidcarve
