// Quality of service, written as a sentence: Qos().reliable(DDS_MSECS(100)).keep_last(16).
#pragma once

#include <dds/dds.h>

#include <memory>
#include <string>

namespace fjr::dds {

class Qos {
 public:
  Qos() : qos_(dds_create_qos()) {}

  Qos& reliable(dds_duration_t max_blocking) {
    return set(dds_qset_reliability, DDS_RELIABILITY_RELIABLE, max_blocking);
  }
  Qos& best_effort() { return set(dds_qset_reliability, DDS_RELIABILITY_BEST_EFFORT, dds_duration_t{0}); }
  Qos& transient_local() { return set(dds_qset_durability, DDS_DURABILITY_TRANSIENT_LOCAL); }
  Qos& keep_all() { return set(dds_qset_history, DDS_HISTORY_KEEP_ALL, 0); }
  Qos& keep_last(int depth) { return set(dds_qset_history, DDS_HISTORY_KEEP_LAST, depth); }
  Qos& lifespan(dds_duration_t duration) { return set(dds_qset_lifespan, duration); }
  Qos& deadline(dds_duration_t period) { return set(dds_qset_deadline, period); }
  Qos& exclusive_ownership() { return set(dds_qset_ownership, DDS_OWNERSHIP_EXCLUSIVE); }
  Qos& ownership_strength(int strength) { return set(dds_qset_ownership_strength, strength); }
  Qos& automatic_liveliness(dds_duration_t lease) { return set(dds_qset_liveliness, DDS_LIVELINESS_AUTOMATIC, lease); }
  Qos& manual_liveliness(dds_duration_t lease) {
    return set(dds_qset_liveliness, DDS_LIVELINESS_MANUAL_BY_TOPIC, lease);
  }
  Qos& late_joiners_get(int depth) {
    dds_qset_durability_service(qos_.get(), 0, DDS_HISTORY_KEEP_LAST, depth, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED);
    return *this;
  }
  Qos& ignore_own() { return set(dds_qset_ignorelocal, DDS_IGNORELOCAL_PARTICIPANT); }  // of the same participant
  Qos& keep_instances() { return set(dds_qset_writer_data_lifecycle, false); }          // when their writer goes
  Qos& user_data(const std::string& text) { return set(dds_qset_userdata, text.data(), text.size()); }
  Qos& partition(const std::string& name) { return set(dds_qset_partition1, name.c_str()); }
  Qos& property(const std::string& name, const std::string& value) {
    return set(dds_qset_prop, name.c_str(), value.c_str());
  }

  const dds_qos_t* get() const { return qos_.get(); }

 private:
  template <class Set, class... Values>
  Qos& set(Set function, Values... values) {
    function(qos_.get(), values...);
    return *this;
  }

  struct Delete {
    void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
  };
  std::unique_ptr<dds_qos_t, Delete> qos_;
};

}  // namespace fjr::dds
