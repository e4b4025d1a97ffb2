#include "server/listen.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

/* Split HOST:PORT; brackets around an IPv6 host go away. */
static int split(const char *address, char host[256], char port[8])
{
	const char *colon = strrchr(address, ':');
	size_t len;

	if (colon == NULL || colon[1] == '\0' || strlen(colon + 1) > 5 ||
	    strspn(colon + 1, "0123456789") != strlen(colon + 1))
		return -1;
	len = (size_t)(colon - address);
	if (len >= 2 && address[0] == '[' && address[len - 1] == ']') {
		address++;
		len -= 2;
	} else if (memchr(address, ':', len) != NULL) {
		return -1;
	}
	if (len >= 256)
		return -1;
	memcpy(host, address, len);
	host[len] = '\0';
	memcpy(port, colon + 1, strlen(colon + 1) + 1);
	return 0;
}

static int resolve(const char *address, int flags, struct addrinfo **found)
{
	struct addrinfo hints = {.ai_socktype = SOCK_STREAM, .ai_flags = flags | AI_NUMERICSERV};
	char host[256], port[8];

	if (split(address, host, port) != 0)
		return EAI_NONAME;
	return getaddrinfo(host[0] != '\0' ? host : NULL, port, &hints, found);
}

static void name_url(int fd, char *url, size_t size)
{
	struct sockaddr_storage at;
	socklen_t len = sizeof at;
	char host[INET6_ADDRSTRLEN] = "?";

	memset(&at, 0, sizeof at);
	(void)getsockname(fd, (struct sockaddr *)&at, &len);
	if (at.ss_family == AF_INET6) {
		struct sockaddr_in6 *six = (struct sockaddr_in6 *)&at;

		(void)inet_ntop(AF_INET6, &six->sin6_addr, host, sizeof host);
		(void)snprintf(url, size, "http://[%s]:%u", host, ntohs(six->sin6_port));
	} else {
		struct sockaddr_in *four = (struct sockaddr_in *)&at;

		(void)inet_ntop(AF_INET, &four->sin_addr, host, sizeof host);
		(void)snprintf(url, size, "http://%s:%u", host, ntohs(four->sin_port));
	}
}

int srv_listen_open(const char *address, char *url, size_t url_size, char *why, size_t size)
{
	struct addrinfo *found;
	int rc = resolve(address, AI_PASSIVE, &found), one = 1, fd;

	if (rc != 0) {
		(void)snprintf(why, size, "cannot listen on %.200s: not an address", address);
		return -1;
	}
	fd = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
	if (fd >= 0) {
		(void)setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one);
		if (found->ai_family == AF_INET6)
			(void)setsockopt(fd, IPPROTO_IPV6, IPV6_V6ONLY, &one, sizeof one);
		if (bind(fd, found->ai_addr, found->ai_addrlen) != 0 || listen(fd, 1024) != 0) {
			int saved = errno;

			close(fd);
			errno = saved;
			fd = -1;
		}
	}
	if (fd < 0)
		(void)snprintf(why, size, "cannot listen on %.200s: %s", address, strerror(errno));
	else
		name_url(fd, url, url_size);
	freeaddrinfo(found);
	return fd;
}

static void loopback(struct sockaddr *address)
{
	if (address->sa_family == AF_INET) {
		struct sockaddr_in *four = (struct sockaddr_in *)address;

		if (four->sin_addr.s_addr == htonl(INADDR_ANY))
			four->sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	} else if (address->sa_family == AF_INET6) {
		struct sockaddr_in6 *six = (struct sockaddr_in6 *)address;

		if (IN6_IS_ADDR_UNSPECIFIED(&six->sin6_addr))
			six->sin6_addr = in6addr_loopback;
	}
}

int srv_listen_connect(const char *address, int seconds)
{
	struct timeval limit = {.tv_sec = seconds};
	struct addrinfo *found;
	int fd;

	if (resolve(address, AI_PASSIVE, &found) != 0)
		return -1;
	loopback(found->ai_addr);
	fd = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (fd >= 0) {
		(void)setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
		(void)setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
		if (connect(fd, found->ai_addr, found->ai_addrlen) != 0) {
			close(fd);
			fd = -1;
		}
	}
	freeaddrinfo(found);
	return fd;
}
