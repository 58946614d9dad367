// Serves one text by HTTP on the loopback interface: http://127.0.0.1:PORT/metrics. It knows nothing of who publishes
// the text, and nobody who reads it, however slowly, can keep the publisher from its work.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <thread>

namespace fjr {

class MetricsServer {
 public:
  // 0: any port that is free, which the log names. One that is taken is told, and tried again until it is free.
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
