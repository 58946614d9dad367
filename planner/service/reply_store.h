// Stores the replies on disk, so that a service that restarts, even after a crash, gives the same answer to the same
// id. A thread of its own writes all waiting changes in one transaction. A slow or full disk does not block the
// service: replies that cannot be written are sent without being stored.
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "planner/protocol/messages.h"
#include "planner/store/database.h"

namespace fjr {

class ReplyStore {
 public:
  // Creates the folder if necessary. Several services may share it; each reads only the replies of its robot. `wake` is
  // called from another thread whenever take_settled() has new results.
  ReplyStore(std::filesystem::path folder, std::string robot_id, std::function<void()> wake);
  ~ReplyStore();  // writes the waiting changes

  // Returns the replies from before this start, the oldest first. To be called once.
  std::vector<SharedReply> take_earlier() { return std::move(earlier_); }

  void add(SharedReply reply);
  void forget(const RequestId& id);

  // Returns the ids of replies that may now be sent, because they are on disk or cannot be written.
  std::vector<RequestId> take_settled();

 private:
  using Clock = std::chrono::steady_clock;
  struct Change {
    RequestId id;
    SharedReply reply;  // null: delete the record
  };

  void load();
  void read_earlier();
  void set_aside(const std::string& why);
  void open();
  void write(const std::vector<Change>& changes);
  std::string try_to_write(const std::vector<Change>& changes);
  void keep_writing(const std::stop_token& over);
  void put_back();
  void note_settled(const std::vector<Change>& changes);
  void tell(const std::string& problem) const;

  const std::filesystem::path folder_, file_;
  const std::string robot_id_;
  const std::function<void()> wake_;
  std::vector<SharedReply> earlier_;

  std::optional<Database> database_;  // of the thread that writes
  std::mutex mutex_;                  // for all below
  std::condition_variable_any changed_;
  std::vector<Change> changes_;  // to be written
  std::vector<Change> writing_;  // being written; only the thread changes it while busy_since_ is set
  std::vector<RequestId> settled_;
  std::optional<Clock::time_point> busy_since_;
  bool failing_ = false;  // the disk fails: writing is tried again, and replies do not wait for it
  std::jthread writer_;   // declared last, so that it ends before the members it uses
};

}  // namespace fjr
