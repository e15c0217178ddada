#ifndef PLUMBLINE_TEST_APPS_LIVE_PEER_PROCESS_H_
#define PLUMBLINE_TEST_APPS_LIVE_PEER_PROCESS_H_

#include <arpa/inet.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <string>

namespace plumbline {

/// The robot of fast_dds_peer_main.cc in a process of its own. It ends with the object.
class PeerProcess {
 public:
  PeerProcess(int domain, const std::string& ros_namespace = "") {
    int in[2], out[2];
    if (pipe(in) != 0 || pipe(out) != 0) return;
    process_ = fork();
    if (process_ == 0) {
      dup2(in[0], STDIN_FILENO);
      dup2(out[1], STDOUT_FILENO);
      for (const int descriptor : {in[0], in[1], out[0], out[1]}) close(descriptor);
      const std::string number = std::to_string(domain);
      execl(PLUMBLINE_LIVE_PEER, PLUMBLINE_LIVE_PEER, number.c_str(), ros_namespace.c_str(),
            nullptr);
      _exit(127);
    }
    close(in[0]);
    close(out[1]);
    commands_ = fdopen(in[1], "w");
    answers_ = fdopen(out[0], "r");
  }
  ~PeerProcess() {
    if (commands_ != nullptr) fclose(commands_);
    if (answers_ != nullptr) fclose(answers_);
    if (process_ > 0) {
      kill(process_, SIGKILL);
      waitpid(process_, nullptr, 0);
    }
  }
  PeerProcess(const PeerProcess&) = delete;
  PeerProcess& operator=(const PeerProcess&) = delete;

  /// Sends a command and returns its answer; empty if the peer has ended.
  std::string Ask(const std::string& command) {
    fputs((command + "\n").c_str(), commands_);
    fflush(commands_);
    std::string line;
    for (int c = 0; (c = fgetc(answers_)) != EOF && c != '\n';) line += static_cast<char>(c);
    const std::string start = "done ";
    return line.rfind(start, 0) == 0 ? line.substr(start.size()) : "";
  }

 private:
  pid_t process_ = 0;
  FILE *commands_ = nullptr, *answers_ = nullptr;
};

/// A domain of DDS whose ports for finding participants are free on the loopback: not the same in
/// each process.
inline int FreeDomain() {
  static int last = getpid() % 90;
  for (int i = 0; i < 90; ++i) {
    last = (last + 7) % 90;
    const int domain = 10 + last;
    bool is_free = true;
    for (int participant = 0; participant < 4 && is_free; ++participant) {
      const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
      sockaddr_in address = {};
      address.sin_family = AF_INET;
      address.sin_port = htons(static_cast<std::uint16_t>(7410 + 250 * domain + 2 * participant));
      address.sin_addr.s_addr = htonl(INADDR_ANY);
      is_free = bind(descriptor, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
      close(descriptor);
    }
    if (is_free) return domain;
  }
  return 100;
}

}  // namespace plumbline

#endif  // PLUMBLINE_TEST_APPS_LIVE_PEER_PROCESS_H_
