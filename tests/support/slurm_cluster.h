#pragma once

#include "tests/support/program.h"

#include <fmt/format.h>

#include <arpa/inet.h>
#include <pwd.h>
#include <sys/socket.h>
#include <unistd.h>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <map>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

/// A Slurm with four nodes on this machine: daemons, configuration, key and ports of its own, all
/// in one folder, ended with the object. Nodes are found lost after some 10 s, and what they ran
/// starts again 6 s later.
class SlurmCluster {
public:
    static bool installed() {
        return call_shell("PATH=$PATH:/usr/sbin; command -v slurmctld slurmd munged sbatch").code ==
               0;
    }

    SlurmCluster() {
        const auto user = std::string(getpwuid(getuid())->pw_name);
        const auto port = free_ports(nodes + 1);
        auto conf = fmt::format(R"(ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmctldPort={1}
SlurmUser={2}
SlurmdUser={2}
AuthType=auth/munge
AuthInfo=socket={0}/munge.socket,cred_expire=5
CredType=cred/munge
StateSaveLocation={0}/state
SlurmdSpoolDir={0}/%n
SlurmctldPidFile={0}/slurmctld.pid
SlurmdPidFile={0}/slurmd-%n.pid
SlurmctldLogFile={0}/slurmctld.log
SlurmdLogFile={0}/slurmd-%n.log
JobCompType=jobcomp/filetxt
JobCompLoc={0}/ended
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=batch_sched_delay=0,bf_interval=1,sched_interval=1,sched_min_interval=0
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
ReturnToService=2
SlurmdTimeout=4
MessageTimeout=4
TCPTimeout=1
KillWait=5
)",
                                folder.path(), port[0], user);
        for (int node = 1; node <= nodes; ++node) {
            conf += fmt::format(
                "NodeName=n{} NodeHostname=localhost NodeAddr=127.0.0.1 Port={} CPUs=2 "
                "CoresPerSocket=2 RealMemory=8000\n",
                node, port[static_cast<std::size_t>(node)]);
            std::filesystem::create_directories(folder / fmt::format("n{}", node));
        }
        conf +=
            fmt::format("PartitionName=main Nodes=n[1-{}] Default=YES MaxTime=INFINITE\n", nodes);
        folder.write("slurm.conf", conf);
        folder.write("cgroup.conf", "CgroupPlugin=cgroup/v1\nCgroupAutomount=no\n");
        std::filesystem::create_directories(folder / "state");
        call_shell(fmt::format(
            "chmod 755 {0}; head -c 1024 /dev/urandom >{0}/key; chmod 400 {0}/key", folder.path()));
        start(
            "munged",
            fmt::format("munged --foreground --force --key-file={0}/key --socket={0}/munge.socket "
                        "--pid-file={0}/munged.pid --seed-file={0}/seed",
                        folder.path()));
        wait_for([&] { return std::filesystem::exists(folder / "munge.socket"); });
        start("slurmctld", "slurmctld -D");
        for (int node = 1; node <= nodes; ++node)
            start(fmt::format("n{}", node), fmt::format("slurmd -D -N n{}", node));
        wait_for([&] {
            return call("sinfo --noheader --Node --format=%T | grep -c '^idle$'").out ==
                   fmt::format("{}\n", nodes);
        });
    }
    ~SlurmCluster() {
        call(
            "scancel --quiet --user=$(id -un); while squeue --noheader | grep -q .; do sleep 0.1; "
            "done");
        for (const auto& [name, process] : processes_)
            kill(process, name.starts_with('n') ? SIGKILL : SIGTERM);
        for (const auto& [name, process] : processes_)
            for (int n = 0; n < 100 && alive(process); ++n)
                std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    SlurmCluster(const SlurmCluster&) = delete;
    SlurmCluster& operator=(const SlurmCluster&) = delete;

    /// Runs a shell command for which this is the machine's Slurm.
    Called call(const std::string& command) const {
        return call_shell(fmt::format("export SLURM_CONF={}; {}", folder / "slurm.conf", command));
    }

    /// Waits until no job is left.
    void wait_until_empty() const {
        wait_for([&] { return call("squeue --noheader").out.empty(); });
    }
    /// Waits until a task of a step runs. @return its node
    std::string node_of(const std::string& step) const {
        std::string out;
        wait_for([&] {
            return !(out = call(fmt::format("squeue --noheader --states=running --format='%j %N' | "
                                            "sed -n 's/.*[.]{} //p' | head -1",
                                            step))
                               .out)
                        .empty();
        });
        out.pop_back();
        return out;
    }
    /// Kills a node with all that it runs, as if it had lost its power.
    void kill_node(const std::string& node) const {
        kill(processes_.at(node), SIGKILL);
        call(
            fmt::format("ended() {{ for child in $(pgrep -P $1); do ended $child; done; kill -9 "
                        "$1; }}; for task in $(pgrep -f '^[^ ]*bash {}/job'); do "
                        "kill -9 $(ps -o ppid= $task); ended $task; done",
                        folder / node));
    }
    /// What Slurm has noted of jobs that ended: a line for each end, with JobState.
    std::string ended() const { return Scratch::read(folder / "ended"); }

    Scratch folder;

private:
    static constexpr int nodes = 4;

    static std::vector<int> free_ports(int count) {
        std::vector<int> ports, sockets;
        for (int n = 0; n < count; ++n) {
            sockaddr_in address{};
            address.sin_family = AF_INET;
            address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
            socklen_t size = sizeof address;
            sockets.push_back(socket(AF_INET, SOCK_STREAM, 0));
            bind(sockets.back(), reinterpret_cast<sockaddr*>(&address), size);
            getsockname(sockets.back(), reinterpret_cast<sockaddr*>(&address), &size);
            ports.push_back(ntohs(address.sin_port));
        }
        for (const auto each : sockets) close(each);
        return ports;
    }
    static bool alive(pid_t process) {
        const auto about = Scratch::read(fmt::format("/proc/{}/stat", process));
        return !about.empty() && about.find(") Z ") == std::string::npos;
    }
    template <class Condition>
    static void wait_for(const Condition& condition) {
        for (const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(90);
             !condition();) {
            if (std::chrono::steady_clock::now() > end)
                throw std::runtime_error("Slurm does not answer");
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
    }
    void start(const std::string& name, const std::string& command) {
        const auto started =
            call(fmt::format("PATH=$PATH:/usr/sbin; {} >{} 2>&1 </dev/null & echo $!", command,
                             folder / (name + ".out")));
        processes_[name] = std::stoi(started.out);
    }

    std::map<std::string, pid_t> processes_;
};
