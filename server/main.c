#include <stdio.h>
#include <string.h>

#include "api/capabilities.h"
#include "server/calc.h"
#include "server/config.h"
#include "server/health.h"
#include "server/log.h"
#include "server/master.h"

static int act(struct srv_config *config)
{
	if (config->help) {
		srv_config_help();
		return 0;
	}
	if (config->version) {
		(void)printf("masspropd %s\n", api_version);
		return 0;
	}
	if (config->health)
		return srv_health_ask(config);
	srv_log_setup(config->log_level, config->log_json, "master");
	return srv_master_run(config);
}

int main(int argc, char **argv)
{
	struct srv_config config;
	char why[300];
	int status = 2;

	if (argc > 1 && strcmp(argv[1], "calc") == 0)
		return srv_calc_main(argc - 1, argv + 1);
	if (srv_config_load(&config, argc, argv, why, sizeof why) != 0)
		(void)fprintf(stderr, "masspropd: %s\n", why);
	else
		status = act(&config);
	srv_config_free(&config);
	return status;
}
