#pragma once

#include "nodes/python/shared_memory.h"

#include <nlohmann/json.hpp>

#include <sys/types.h>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace fluidcarve {

/// Callbacks of a worker during a call.
struct WorkerHost {
    std::function<bool()> cancelled = [] { return false; };
    std::function<void(const std::string&)> warn = [](const std::string&) {};
    std::function<void(double)> progress = [](double) {};
};

/// Limits of a call, or of the import of the script.
struct WorkerLimits {
    double seconds;        ///< after that the process is ended
    std::uint64_t memory;  ///< bytes of the process
};

/// A process of Python that runs the functions of one script: python/fluidcarve/worker.py. Both
/// processes exchange lines of JSON over a socket, and arrays in shared memory. It ends with this
/// object, and with this program, however that ends.
class Worker {
public:
    /// Starts the process, and imports the script.
    /// @param interpreter  a path, or a name on PATH
    /// @throws Failure with the script's traceback; or if the interpreter can't be started or has
    ///   no numpy
    /// @throws Cancelled
    Worker(const std::string& interpreter, const std::string& script, const WorkerLimits& limits,
           const WorkerHost& host);
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    /// Sends a request, and waits for its answer.
    /// @throws Failure with the script's traceback, or with its place if the process ended or was
    ///   ended
    /// @throws Cancelled
    nlohmann::json call(nlohmann::json request, const WorkerLimits& limits, const WorkerHost& host);
    /// Whether it can be called again.
    bool alive() const { return process_ > 0; }

    SharedMemory given, answered;  ///< written by this program, and by the worker
    std::vector<int> frames;       ///< the frames of the sequence, as the worker knows them
    std::string found;             ///< result of the script's `finish`, as the worker knows it

private:
    void start();
    void send(const std::string& line);
    /// Parses a line of the worker.
    /// @throws Failure if it is not a message of a worker, or answers another request; then ends
    ///   the process
    nlohmann::json understood(const std::string& line);
    /// Moves a received line to `line`. @return false if there is none yet
    bool next_line(std::string& line);
    /// Waits a moment for more data. @return false if the process has closed the socket
    bool receive();
    /// Ends the process. @param going  whether it is already ending by itself
    void end(bool going = false);
    /// What the script printed since the last call.
    std::string printed();
    /// Why the process is gone, with the place in the script.
    std::string last_words();

    std::string interpreter_, script_;
    pid_t process_ = -1;
    int socket_ = -1;
    int life_ = -1;  ///< the process ends once this is closed
    int log_ = -1;   ///< what the process prints
    int status_ = 0;
    bool ready_ = false;       ///< the process has begun to run the script
    std::uint64_t calls_ = 0;  ///< each answer has the number of its request
    double seconds_ = 0;       ///< of the last call
    std::string read_;
};

}  // namespace fluidcarve
