// Signatures of trajectories. In a domain with DDS Security a trajectory is signed with its publisher's identity, so
// that the executor need not trust what it came through.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "planner/protocol/execution_messages.h"

struct evp_pkey_st;
struct x509_store_st;

namespace fjr {

inline constexpr std::string_view kPublisherRole = "service";  // OU of the certificate; config/security/roles.txt
inline constexpr std::size_t kLongestSignature = 512, kLongestCertificate = 8192;  // [bytes] of idl/fjr_msgs.idl

// Returns the bytes of a trajectory that are signed: all members in the order of fjr::msg::Trajectory2 and without
// padding. They begin with "fjr/trajectory_2", or "fjr/learnt_trajectory" if its rows were learnt; then follows every
// member up to `stops`. Numbers are little-endian, booleans one byte; strings and sequences are preceded by their
// length, 32 bits.
std::string signed_bytes(const TrajectoryOrder& order);

class Signer {
 public:
  // Reads cert.pem and key.pem of the credentials in `folder` (dds/credentials.h), and checks that signatures made with
  // them pass the SignatureCheck of this folder and fit into a message. Throws InputError naming the file.
  explicit Signer(const std::filesystem::path& folder, std::string_view role = kPublisherRole);

  // Signs with SHA-256 and the key's algorithm (ECDSA for those of make_credentials.sh). Throws std::runtime_error.
  Signature sign(std::string_view message) const;

 private:
  std::shared_ptr<evp_pkey_st> key_;
  std::string certificate_;  // DER
};

class SignatureCheck {
 public:
  // Reads identity_ca.cert.pem of the credentials in `folder`. Throws InputError.
  explicit SignatureCheck(const std::filesystem::path& folder);

  // Returns a sentence if the message is not signed, its signer is unknown to the identity authority or has another
  // role, or the signature is not that of this message.
  std::optional<std::string> fault_of(std::string_view message, const Signature& signature,
                                      std::string_view role) const;

 private:
  std::shared_ptr<x509_store_st> authority_;
};

}  // namespace fjr
