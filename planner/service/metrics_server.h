// Serves one text by HTTP on the loopback interface: http://127.0.0.1:PORT/metrics. Slow readers do not block the
// thread that publishes the text.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <thread>

namespace fjr {

class MetricsServer {
 public:
  // port: 0 chooses a free port, which is logged. If the port is taken, that is logged, and it is tried again until
  // free.
  explicit MetricsServer(std::uint16_t port);
  ~MetricsServer();
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;

  void publish(std::string text);

 private:
  struct Shared;
  std::shared_ptr<Shared> shared_;
  std::thread thread_;
};

}  // namespace fjr
