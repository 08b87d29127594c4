// The page of the demonstration: two runs side by side.

listen();
show(scenesOf(JSON.parse(element("runs").textContent), document.querySelectorAll(".pair canvas")));
