#include "server/health.h"

#include <stdio.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/listen.h"

int srv_health_ask(const struct srv_config *config)
{
	static const char ask[] =
	    "GET /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n";
	int fd = srv_listen_connect(config->listen[0], 3);
	char head[16] = "";
	size_t got = 0;

	if (fd >= 0 && send(fd, ask, sizeof ask - 1, MSG_NOSIGNAL) == (ssize_t)sizeof ask - 1) {
		while (got < sizeof head - 1) {
			ssize_t n = recv(fd, head + got, sizeof head - 1 - got, 0);

			if (n <= 0)
				break;
			got += (size_t)n;
		}
	}
	if (fd >= 0)
		close(fd);
	if (strncmp(head, "HTTP/1.1 200", 12) == 0)
		return 0;
	(void)fprintf(stderr, "masspropd: no answer from %s/livez\n", config->listen[0]);
	return 1;
}
