#include "planner/protocol/signature.h"

#include <fmt/format.h>
#include <openssl/evp.h>
#include <openssl/objects.h>
#include <openssl/pem.h>
#include <openssl/x509_vfy.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <new>
#include <stdexcept>
#include <type_traits>
#include <utility>

#include "common/input_error.h"
#include "common/strict_yaml.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

// The code below copies memory: this requires little-endian numbers, and rows and stops that are doubles without
// padding.
static_assert(std::endian::native == std::endian::little);
static_assert(sizeof(Sample) == 11 * sizeof(double) && std::is_trivially_copyable_v<Sample>);
static_assert(sizeof(StopMotion) == 14 * sizeof(double) && std::is_trivially_copyable_v<StopMotion>);

class Bytes {
 public:
  explicit Bytes(const char* topic) : text_(topic) {}

  template <class T>
  void number(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    text_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void string(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    text_.append(text);
  }
  template <class T>
  void list(const std::vector<T>& items) {
    number(static_cast<std::uint32_t>(items.size()));
    text_.append(reinterpret_cast<const char*>(items.data()), items.size() * sizeof(T));
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

using File = std::unique_ptr<BIO, decltype(&BIO_free)>;
using Identity = std::unique_ptr<X509, decltype(&X509_free)>;
using Digest = std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)>;

File open(const fs::path& file) {
  File in(BIO_new_file(file.c_str(), "r"), BIO_free);
  if (in) return in;
  const bool there = fs::is_regular_file(file);
  throw InputError(file.string(), "",
                   there ? "cannot be read; trajectories are signed by it" : "no such file; DDS Security needs it");
}

Identity certificate_in(const fs::path& file) {
  Identity certificate(PEM_read_bio_X509(open(file).get(), nullptr, nullptr, nullptr), X509_free);
  if (!certificate) throw InputError(file.string(), "", "is no certificate in PEM");
  return certificate;
}

std::string der_of(X509* certificate) {
  std::string der(static_cast<std::size_t>(std::max(0, i2d_X509(certificate, nullptr))), '\0');
  auto* to = reinterpret_cast<unsigned char*>(der.data());
  i2d_X509(certificate, &to);
  return der;
}

Identity certificate_of(const std::string& der) {
  const auto* from = reinterpret_cast<const unsigned char*>(der.data());
  return {d2i_X509(nullptr, &from, static_cast<long>(der.size())), X509_free};
}

std::string name_in(X509* certificate, int which) {
  std::array<char, 128> text{};
  const int length =
      X509_NAME_get_text_by_NID(X509_get_subject_name(certificate), which, text.data(), static_cast<int>(text.size()));
  return length > 0 ? std::string(text.data(), static_cast<std::size_t>(length)) : std::string();
}

// Returns why the authority does not know the certificate, unless it does.
std::optional<std::string> why_unknown(X509_STORE* authority, X509* certificate) {
  const std::unique_ptr<X509_STORE_CTX, decltype(&X509_STORE_CTX_free)> context(X509_STORE_CTX_new(),
                                                                                X509_STORE_CTX_free);
  if (!context || X509_STORE_CTX_init(context.get(), authority, certificate, nullptr) != 1) return "out of memory";
  if (X509_verify_cert(context.get()) == 1) return std::nullopt;
  return X509_verify_cert_error_string(X509_STORE_CTX_get_error(context.get()));
}

const unsigned char* bytes_of(std::string_view text) { return reinterpret_cast<const unsigned char*>(text.data()); }

bool fits(X509* certificate, std::string_view message, const std::string& value) {
  const Digest digest(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  return digest &&
         EVP_DigestVerifyInit(digest.get(), nullptr, EVP_sha256(), nullptr, X509_get0_pubkey(certificate)) == 1 &&
         EVP_DigestVerify(digest.get(), bytes_of(value), value.size(), bytes_of(message), message.size()) == 1;
}

// Returns a sentence why an executor would not accept signatures with this certificate, unless it would.
std::optional<std::string> fault_of_certificate(X509* certificate, std::size_t size, std::string_view role) {
  if (const std::string own = name_in(certificate, NID_organizationalUnitName); own != role) {
    return fmt::format("its role (OU) is {}; trajectories are signed as {}", shown(own), shown(role));
  }
  if (size <= kLongestCertificate) return std::nullopt;
  return fmt::format("has {} bytes, at most {} are allowed", size, kLongestCertificate);
}

std::optional<std::string> fault_of_key(EVP_PKEY* key, X509* certificate) {
  constexpr int kLeastSecurity = 112;  // RSA of 2048 bits, curves of 224
  if (key == nullptr) return "is no private key in PEM";
  if (X509_check_private_key(certificate, key) != 1) return "is not the key of cert.pem";
  if (const int type = EVP_PKEY_base_id(key); type != EVP_PKEY_EC && type != EVP_PKEY_RSA) {
    return fmt::format("is a key for {}; EC and RSA are allowed", OBJ_nid2sn(type));
  }
  if (const int bits = EVP_PKEY_security_bits(key); bits < kLeastSecurity) {
    return fmt::format("has {} bits of security, at least {} are needed", bits, kLeastSecurity);
  }
  const auto size = static_cast<std::size_t>(EVP_PKEY_size(key));
  if (size <= kLongestSignature) return std::nullopt;
  return fmt::format("makes signatures of {} bytes, at most {} are allowed", size, kLongestSignature);
}

}  // namespace

std::string signed_bytes(const TrajectoryOrder& order) {
  Bytes bytes(order.learnt ? "fjr/learnt_trajectory" : "fjr/trajectory_2");
  bytes.string(order.robot_id);
  bytes.number(order.id.client);
  bytes.number(order.id.number);
  bytes.number(order.epoch);
  bytes.number(order.published);
  bytes.string(order.robot_hash);
  bytes.string(order.request_hash);
  bytes.number(static_cast<std::uint8_t>(order.certified));
  bytes.number(static_cast<std::uint8_t>(order.ends_at_rest));
  bytes.number(order.certified_error);
  bytes.number(order.predicted_error);
  bytes.number(order.tolerances.path);
  bytes.number(order.tolerances.goal);
  bytes.number(order.tolerances.goal_time);
  bytes.number(order.tolerances.stopped_velocity);
  bytes.list(order.rows);
  bytes.list(order.stops);
  return bytes.take();
}

Signer::Signer(const fs::path& folder, std::string_view role) {
  const fs::path certificate_file = folder / "cert.pem", key_file = folder / "key.pem";
  const Identity certificate = certificate_in(certificate_file);
  certificate_ = der_of(certificate.get());
  key_ = {PEM_read_bio_PrivateKey(open(key_file).get(), nullptr, nullptr, nullptr), EVP_PKEY_free};
  const auto refuse_if = [](const fs::path& file, const std::optional<std::string>& fault) {
    if (fault) throw InputError(file.string(), "", *fault);
  };
  refuse_if(certificate_file, fault_of_certificate(certificate.get(), certificate_.size(), role));
  refuse_if(key_file, fault_of_key(key_.get(), certificate.get()));
  constexpr std::string_view kTrial = "a trajectory";
  refuse_if(certificate_file, SignatureCheck(folder).fault_of(kTrial, sign(kTrial), role));
}

Signature Signer::sign(std::string_view message) const {
  const Digest digest(EVP_MD_CTX_new(), EVP_MD_CTX_free);
  std::string value(static_cast<std::size_t>(EVP_PKEY_size(key_.get())), '\0');
  std::size_t size = value.size();
  if (!digest || EVP_DigestSignInit(digest.get(), nullptr, EVP_sha256(), nullptr, key_.get()) != 1 ||
      EVP_DigestSign(digest.get(), reinterpret_cast<unsigned char*>(value.data()), &size, bytes_of(message),
                     message.size()) != 1) {
    throw std::runtime_error("a trajectory cannot be signed with this key");
  }
  value.resize(size);
  return {std::move(value), certificate_};
}

SignatureCheck::SignatureCheck(const fs::path& folder) : authority_(X509_STORE_new(), X509_STORE_free) {
  const Identity certificate = certificate_in(folder / "identity_ca.cert.pem");
  if (!authority_ || X509_STORE_add_cert(authority_.get(), certificate.get()) != 1) throw std::bad_alloc();
}

std::optional<std::string> SignatureCheck::fault_of(std::string_view message, const Signature& signature,
                                                    std::string_view role) const {
  if (signature.value.empty()) return "not signed, as everything is that is run in a domain with DDS Security";
  const Identity signer = certificate_of(signature.signer);
  if (!signer) return "signed by nobody: the signer's certificate cannot be read";
  const std::string name = shown(name_in(signer.get(), NID_commonName));
  if (const auto why = why_unknown(authority_.get(), signer.get())) {
    return fmt::format("signed by {}, for whom the identity authority does not vouch: {}", name, *why);
  }
  if (const std::string own = name_in(signer.get(), NID_organizationalUnitName); own != role) {
    return fmt::format("signed by {}, whose role is {} and not {}", name, shown(own), shown(role));
  }
  if (!fits(signer.get(), message, signature.value)) {
    return fmt::format("altered after {} signed it, or not signed by it at all", name);
  }
  return std::nullopt;
}

}  // namespace fjr
