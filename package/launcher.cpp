// bin/fluidcarve of the archive. It is linked statically, so it runs on any Linux; it starts the
// program by the loader and with the libraries that lie beside it. The loader bears the program's
// name, which is what `ps` and `killall` show of the process.

#include <unistd.h>
#include <climits>
#include <cstdio>
#include <string>
#include <vector>

int main(int argc, char** argv) {
    std::string own(PATH_MAX, '\0');
    const auto size = readlink("/proc/self/exe", own.data(), own.size());
    if (size <= 0)
        return std::perror(
                   "fluidcarve: /proc/self/exe, which tells where its libraries are, cannot be "
                   "read; mount /proc"),
               1;
    own.resize(static_cast<std::size_t>(size));
    auto folder = own.substr(0, own.rfind('/'));
    folder = folder.substr(0, folder.rfind('/')) + "/lib/fluidcarve/";
    if (folder.find_first_of(":;") != std::string::npos)
        return std::fprintf(stderr,
                            "fluidcarve: the loader takes no ':' and no ';' in %s; give that "
                            "folder another name\n",
                            folder.c_str()),
               1;

    // The path in place of LD_LIBRARY_PATH holds for this process alone, as no variable is set. The
    // program takes `own` for its path.
    std::string words[] = {own,
                           "--argv0",
                           own,
                           "--inhibit-cache",
                           "--library-path",
                           folder + "libraries:" + folder,
                           folder + "program/fluidcarve"};
    std::vector<char*> command;
    for (auto& word : words) command.push_back(word.data());
    command.insert(command.end(), argv + 1, argv + argc);
    command.push_back(nullptr);
    const auto loader = folder + "loader/fluidcarve";
    execv(loader.c_str(), command.data());
    return std::perror(("fluidcarve: " + loader + "; unpack the whole archive").c_str()), 1;
}
