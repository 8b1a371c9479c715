"""Final renders: settings, plan, the session that runs the passes, results and denoising."""
